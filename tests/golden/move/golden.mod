MODULE golden
  ! Written by Seampath.
  ! Frame: robot base; base_from_scan is 0 0 0 mm, quaternion w x y z 1 0 0 0.
  ! Tool: +Z along the torch into the joint, +X along travel.
  ! Moves stay within 0.0157 mm of the seam.
  ! Positions are rounded by up to 0.0005 mm.
  ! Units: mm, mm/s; quaternions w, x, y, z. Positions are those of tool0 in wobj0.
  LOCAL CONST speeddata speed0:=[100,500,5000,1000];
  LOCAL CONST speeddata speed1:=[8.5,500,5000,1000];
  LOCAL CONST speeddata speed2:=[250,500,5000,1000];
  LOCAL CONST speeddata speed3:=[12,500,5000,1000];
  PROC main()
    golden_seam0;
    golden_seam1;
  ENDPROC
  PROC golden_seam0()
    ConfL\Off;
    ConfJ\Off;
    MoveJ [[10.250,-4.000,30.000],[0.00000000,1.00000000,0.00000000,0.00000000],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]],speed0,fine,tool0\WObj:=wobj0;
    MoveL [[10.250,-4.000,0.000],[0.00000000,1.00000000,0.00000000,0.00000000],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]],speed0,fine,tool0\WObj:=wobj0;
    MoveL [[50.250,-4.000,0.062],[0.00000000,1.00000000,0.00000000,0.00000000],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]],speed1,z1,tool0\WObj:=wobj0;
    MoveL [[60.750,-4.008,0.062],[0.00000000,0.60000000,0.80000000,0.00000000],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]],speed1,z1,tool0\WObj:=wobj0;
    MoveL [[100.750,-4.008,0.000],[0.00000000,0.60000000,0.80000000,0.00000000],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]],speed1,fine,tool0\WObj:=wobj0;
    MoveL [[100.750,-4.008,30.000],[0.00000000,0.60000000,0.80000000,0.00000000],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]],speed0,fine,tool0\WObj:=wobj0;
  ENDPROC
  PROC golden_seam1()
    ConfL\Off;
    ConfJ\Off;
    MoveL [[60.000,20.000,60.000],[0.00000000,1.00000000,0.00000000,0.00000000],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]],speed2,fine,tool0\WObj:=wobj0;
    MoveL [[50.000,0.000,25.000],[0.50000000,0.50000000,0.50000000,-0.50000000],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]],speed2,fine,tool0\WObj:=wobj0;
    MoveL [[50.000,0.000,0.000],[0.50000000,0.50000000,0.50000000,-0.50000000],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]],speed0,fine,tool0\WObj:=wobj0;
    MoveL [[30.000,40.000,0.000],[0.50000000,0.50000000,0.50000000,-0.50000000],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]],speed3,z1,tool0\WObj:=wobj0;
    MoveL [[-40.000,30.000,0.000],[-0.10000000,0.70000000,0.70000000,0.10000000],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]],speed3,z1,tool0\WObj:=wobj0;
    MoveL [[-30.000,-40.000,0.000],[-0.10000000,0.70000000,0.70000000,0.10000000],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]],speed3,z1,tool0\WObj:=wobj0;
    MoveL [[40.000,-30.000,0.000],[0.50000000,0.50000000,0.50000000,-0.50000000],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]],speed3,z1,tool0\WObj:=wobj0;
    MoveL [[50.000,0.000,0.000],[0.50000000,0.50000000,0.50000000,-0.50000000],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]],speed3,fine,tool0\WObj:=wobj0;
    MoveL [[50.000,0.000,25.000],[0.50000000,0.50000000,0.50000000,-0.50000000],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]],speed0,fine,tool0\WObj:=wobj0;
  ENDPROC
ENDMODULE
