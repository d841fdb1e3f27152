MODULE golden
  ! Written by Seampath.
  ! Frame: robot base; base_from_scan is 1200 -340 75.5 mm, quaternion w x y z 0.5 0.5 -0.5 0.5.
  ! 1-sigma of base_from_scan: 0.12 mm, 0.02 deg.
  ! Tool: +Z along the torch into the joint, +X along travel.
  ! Moves stay within 0.0157 mm of the seam.
  ! Positions are rounded by up to 0.0005 mm.
  ! Units: mm, mm/s; quaternions w, x, y, z. Positions are those of tTorch in wPart.
  ! While welding the robot takes its speed from weld_speed of weld1; the plan's is in the speed data.
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
    MoveJ [[1204.000,-370.000,85.750],[-0.50000000,0.50000000,0.50000000,0.50000000],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]],speed0,fine,tTorch\WObj:=wPart;
    ArcLStart [[1204.000,-340.000,85.750],[-0.50000000,0.50000000,0.50000000,0.50000000],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]],speed0,seam1,weld1\Weave:=weave1,fine,tTorch\WObj:=wPart;
    ArcL [[1204.000,-340.062,125.750],[-0.50000000,0.50000000,0.50000000,0.50000000],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]],speed1,seam1,weld1\Weave:=weave1,z1,tTorch\WObj:=wPart;
    ArcL [[1204.008,-340.062,136.250],[0.10000000,-0.10000000,0.70000000,0.70000000],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]],speed1,seam1,weld1\Weave:=weave1,z1,tTorch\WObj:=wPart;
    ArcLEnd [[1204.008,-340.000,176.250],[0.10000000,-0.10000000,0.70000000,0.70000000],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]],speed1,seam1,weld1\Weave:=weave1,fine,tTorch\WObj:=wPart;
    MoveL [[1204.008,-370.000,176.250],[0.10000000,-0.10000000,0.70000000,0.70000000],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]],speed0,fine,tTorch\WObj:=wPart;
  ENDPROC
  PROC golden_seam1()
    ConfL\Off;
    ConfJ\Off;
    MoveL [[1180.000,-400.000,135.500],[-0.50000000,0.50000000,0.50000000,0.50000000],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]],speed2,fine,tTorch\WObj:=wPart;
    MoveL [[1200.000,-365.000,125.500],[0.50000000,0.50000000,0.50000000,0.50000000],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]],speed2,fine,tTorch\WObj:=wPart;
    ArcLStart [[1200.000,-340.000,125.500],[0.50000000,0.50000000,0.50000000,0.50000000],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]],speed0,seam1,weld1\Weave:=weave1,fine,tTorch\WObj:=wPart;
    ArcL [[1160.000,-340.000,105.500],[0.50000000,0.50000000,0.50000000,0.50000000],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]],speed3,seam1,weld1\Weave:=weave1,z1,tTorch\WObj:=wPart;
    ArcL [[1170.000,-340.000,35.500],[-0.10000000,-0.10000000,0.70000000,0.70000000],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]],speed3,seam1,weld1\Weave:=weave1,z1,tTorch\WObj:=wPart;
    ArcL [[1240.000,-340.000,45.500],[-0.10000000,-0.10000000,0.70000000,0.70000000],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]],speed3,seam1,weld1\Weave:=weave1,z1,tTorch\WObj:=wPart;
    ArcL [[1230.000,-340.000,115.500],[0.50000000,0.50000000,0.50000000,0.50000000],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]],speed3,seam1,weld1\Weave:=weave1,z1,tTorch\WObj:=wPart;
    ArcLEnd [[1200.000,-340.000,125.500],[0.50000000,0.50000000,0.50000000,0.50000000],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]],speed3,seam1,weld1\Weave:=weave1,fine,tTorch\WObj:=wPart;
    MoveL [[1200.000,-365.000,125.500],[0.50000000,0.50000000,0.50000000,0.50000000],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]],speed0,fine,tTorch\WObj:=wPart;
  ENDPROC
ENDMODULE
