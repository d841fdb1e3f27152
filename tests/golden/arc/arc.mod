MODULE arc
  ! Written by Seampath.
  ! Frame: robot base; base_from_scan is 0 0 0 mm, quaternion w x y z 1 0 0 0.
  ! Tool: +Z along the torch into the joint, +X along travel.
  ! Moves stay within 0.0200 mm of the seam.
  ! Positions are rounded by up to 0.0005 mm.
  ! Units: mm, mm/s; quaternions w, x, y, z. Positions are those of tool0 in wobj0.
  ! While welding the robot takes its speed from weld_speed of weld1; the plan's is in the speed data.
  LOCAL CONST speeddata speed0:=[100,500,5000,1000];
  LOCAL CONST speeddata speed1:=[8.5,500,5000,1000];
  PROC main()
    arc_seam0;
  ENDPROC
  PROC arc_seam0()
    ConfL\Off;
    ConfJ\Off;
    CirPathMode\ObjectFrame;
    MoveJ [[50.000,0.000,30.000],[0.00000000,1.00000000,0.00000000,0.00000000],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]],speed0,fine,tool0\WObj:=wobj0;
    ArcLStart [[50.000,0.000,0.000],[0.00000000,1.00000000,0.00000000,0.00000000],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]],speed0,seam1,weld1\Weave:=weave1,fine,tool0\WObj:=wobj0;
    ArcCEnd [[35.834,34.870,0.000],[0.00000000,1.00000000,0.00000000,0.00000000],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]],[[0.000,50.000,0.000],[0.00000000,1.00000000,0.00000000,0.00000000],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]],speed1,seam1,weld1\Weave:=weave1,fine,tool0\WObj:=wobj0;
    MoveL [[0.000,50.000,30.000],[0.00000000,1.00000000,0.00000000,0.00000000],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]],speed0,fine,tool0\WObj:=wobj0;
  ENDPROC
ENDMODULE
