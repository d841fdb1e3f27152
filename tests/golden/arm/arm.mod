MODULE arm
  ! Written by Seampath.
  ! Frame: robot base; base_from_scan is 0 0 0 mm, quaternion w x y z 1 0 0 0.
  ! Tool: +Z along the torch into the joint, +X along travel.
  ! Moves stay within 0.0157 mm of the seam.
  ! Axes are those of Arm 6 standing in that base.
  ! Positions are rounded by up to 0.0005 mm.
  ! Units: mm, mm/s; quaternions w, x, y, z. Positions are those of tool0 in wobj0.
  ! While welding the robot takes its speed from weld_speed of weld1; the plan's is in the speed data.
  LOCAL CONST speeddata speed0:=[100,500,5000,1000];
  LOCAL CONST speeddata speed1:=[8.5,500,5000,1000];
  LOCAL CONST speeddata speed2:=[250,500,5000,1000];
  LOCAL CONST speeddata speed3:=[12,500,5000,1000];
  PROC main()
    arm_seam0;
    arm_seam1;
  ENDPROC
  PROC arm_seam0()
    ConfL\Off;
    ConfJ\Off;
    MoveAbsJ [[0.0000,-28.6479,85.9437,-14.3239,-71.6197,0.0000],[9E9,9E9,9E9,9E9,9E9,9E9]]\NoEOffs,speed0,fine,tool0\WObj:=wobj0;
    ArcLStart [[10.250,-4.000,0.000],[0.00000000,1.00000000,0.00000000,0.00000000],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]],speed0,seam1,weld1\Weave:=weave1,fine,tool0\WObj:=wobj0;
    ArcL [[50.250,-4.000,0.062],[0.00000000,1.00000000,0.00000000,0.00000000],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]],speed1,seam1,weld1\Weave:=weave1,z1,tool0\WObj:=wobj0;
    ArcL [[60.750,-4.008,0.062],[0.00000000,0.60000000,0.80000000,0.00000000],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]],speed1,seam1,weld1\Weave:=weave1,z1,tool0\WObj:=wobj0;
    ArcLEnd [[100.750,-4.008,0.000],[0.00000000,0.60000000,0.80000000,0.00000000],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]],speed1,seam1,weld1\Weave:=weave1,fine,tool0\WObj:=wobj0;
    MoveL [[100.750,-4.008,30.000],[0.00000000,0.60000000,0.80000000,0.00000000],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]],speed0,fine,tool0\WObj:=wobj0;
  ENDPROC
  PROC arm_seam1()
    ConfL\Off;
    ConfJ\Off;
    MoveAbsJ [[42.9718,14.3239,42.9718,-14.3239,-50.1338,-42.9718],[9E9,9E9,9E9,9E9,9E9,9E9]]\NoEOffs,speed2,fine,tool0\WObj:=wobj0;
    MoveAbsJ [[50.1338,21.4859,35.8099,-14.3239,-46.5528,-50.1338],[9E9,9E9,9E9,9E9,9E9,9E9]]\NoEOffs,speed2,fine,tool0\WObj:=wobj0;
    ArcLStart [[50.000,0.000,0.000],[0.50000000,0.50000000,0.50000000,-0.50000000],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]],speed0,seam1,weld1\Weave:=weave1,fine,tool0\WObj:=wobj0;
    ArcL [[30.000,40.000,0.000],[0.50000000,0.50000000,0.50000000,-0.50000000],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]],speed3,seam1,weld1\Weave:=weave1,z1,tool0\WObj:=wobj0;
    ArcL [[-40.000,30.000,0.000],[-0.10000000,0.70000000,0.70000000,0.10000000],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]],speed3,seam1,weld1\Weave:=weave1,z1,tool0\WObj:=wobj0;
    ArcL [[-30.000,-40.000,0.000],[-0.10000000,0.70000000,0.70000000,0.10000000],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]],speed3,seam1,weld1\Weave:=weave1,z1,tool0\WObj:=wobj0;
    ArcL [[40.000,-30.000,0.000],[0.50000000,0.50000000,0.50000000,-0.50000000],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]],speed3,seam1,weld1\Weave:=weave1,z1,tool0\WObj:=wobj0;
    ArcLEnd [[50.000,0.000,0.000],[0.50000000,0.50000000,0.50000000,-0.50000000],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]],speed3,seam1,weld1\Weave:=weave1,fine,tool0\WObj:=wobj0;
    MoveL [[50.000,0.000,25.000],[0.50000000,0.50000000,0.50000000,-0.50000000],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]],speed0,fine,tool0\WObj:=wobj0;
  ENDPROC
ENDMODULE
