/PROG  ARC
/ATTR
OWNER		= MNEDITOR;
COMMENT		= "Seampath";
PROG_SIZE	= 0;
CREATE		= DATE 70-01-01  TIME 00:00:00;
MODIFIED	= DATE 70-01-01  TIME 00:00:00;
FILE_NAME	= ;
VERSION		= 0;
LINE_COUNT	= 20;
MEMORY_SIZE	= 0;
PROTECT		= READ_WRITE;
TCD:  STACK_SIZE	= 0,
      TASK_PRIORITY	= 50,
      TIME_SLICE	= 0,
      BUSY_LAMP_OFF	= 0,
      ABORT_REQUEST	= 0,
      PAUSE_REQUEST	= 0;
DEFAULT_GROUP	= 1,*,*,*,*;
CONTROL_CODE	= 00000000 00000000;
/APPL
  ARC Welding Equipment : 1,*,*,*,*;
/MN
   1:  !Written by Seampath. ;
   2:  !Frame: robot base, ;
   3:  !base_from_scan is 0 0 0 mm, ;
   4:  !quaternion w x y z 1 0 0 0. ;
   5:  !Tool: +Z along the torch into ;
   6:  !the joint, +X along travel. ;
   7:  !Moves stay within 0.0200 mm of ;
   8:  !the seam. ;
   9:  !Positions are rounded by up to ;
  10:  !0.0005 mm. ;
  11:  !Units: mm, deg, W, P, R about X, ;
  12:  !Y, Z. ;
  13:  UFRAME_NUM=1 ;
  14:  UTOOL_NUM=2 ;
  15:J P[1] 10% FINE    ;
  16:L P[2] 100mm/sec FINE
    :  Arc Start[6]    ;
  17:  Weave Sine[8] ;
  18:C P[3]    
    :  P[4] 51cm/min FINE
    :  Arc End[7]    ;
  19:  Weave End ;
  20:L P[5] 100mm/sec FINE    ;
/POS
P[1]{
   GP1:
	UF : 1, UT : 2,		CONFIG : 'N U T, 0, 0, 0',
	X =    50.000  mm,	Y =     0.000  mm,	Z =    30.000  mm,
	W =   180.000 deg,	P =     0.000 deg,	R =     0.000 deg
};
P[2]{
   GP1:
	UF : 1, UT : 2,		CONFIG : 'N U T, 0, 0, 0',
	X =    50.000  mm,	Y =     0.000  mm,	Z =     0.000  mm,
	W =   180.000 deg,	P =     0.000 deg,	R =     0.000 deg
};
P[3]{
   GP1:
	UF : 1, UT : 2,		CONFIG : 'N U T, 0, 0, 0',
	X =    35.834  mm,	Y =    34.870  mm,	Z =     0.000  mm,
	W =   180.000 deg,	P =     0.000 deg,	R =     0.000 deg
};
P[4]{
   GP1:
	UF : 1, UT : 2,		CONFIG : 'N U T, 0, 0, 0',
	X =     0.000  mm,	Y =    50.000  mm,	Z =     0.000  mm,
	W =   180.000 deg,	P =     0.000 deg,	R =     0.000 deg
};
P[5]{
   GP1:
	UF : 1, UT : 2,		CONFIG : 'N U T, 0, 0, 0',
	X =     0.000  mm,	Y =    50.000  mm,	Z =    30.000  mm,
	W =   180.000 deg,	P =     0.000 deg,	R =     0.000 deg
};
/END
