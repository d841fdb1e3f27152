/PROG  GOLDEN
/ATTR
OWNER		= MNEDITOR;
COMMENT		= "Seampath";
PROG_SIZE	= 0;
CREATE		= DATE 70-01-01  TIME 00:00:00;
MODIFIED	= DATE 70-01-01  TIME 00:00:00;
FILE_NAME	= ;
VERSION		= 0;
LINE_COUNT	= 36;
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
   3:  !base_from_scan is 1200 -340 75.5 ;
   4:  !mm, quaternion w x y z 0.5 0.5 ;
   5:  !-0.5 0.5. ;
   6:  !1-sigma of base_from_scan: 0.12 ;
   7:  !mm, 0.02 deg. ;
   8:  !Tool: +Z along the torch into ;
   9:  !the joint, +X along travel. ;
  10:  !Moves stay within 0.0157 mm of ;
  11:  !the seam. ;
  12:  !Positions are rounded by up to ;
  13:  !0.0005 mm. ;
  14:  !Units: mm, deg, W, P, R about X, ;
  15:  !Y, Z. ;
  16:  UFRAME_NUM=1 ;
  17:  UTOOL_NUM=2 ;
  18:J P[1] 10% FINE    ;
  19:L P[2] 100mm/sec FINE
    :  Arc Start[6]    ;
  20:  Weave Sine[8] ;
  21:L P[3] 51cm/min CNT100    ;
  22:L P[4] 51cm/min CNT100    ;
  23:L P[5] 51cm/min FINE
    :  Arc End[7]    ;
  24:  Weave End ;
  25:L P[6] 100mm/sec FINE    ;
  26:L P[7] 250mm/sec FINE    ;
  27:L P[8] 250mm/sec FINE    ;
  28:L P[9] 100mm/sec FINE
    :  Arc Start[6]    ;
  29:  Weave Sine[8] ;
  30:L P[10] 12mm/sec CNT100    ;
  31:L P[11] 12mm/sec CNT100    ;
  32:L P[12] 12mm/sec CNT100    ;
  33:L P[13] 12mm/sec CNT100    ;
  34:L P[14] 12mm/sec FINE
    :  Arc End[7]    ;
  35:  Weave End ;
  36:L P[15] 100mm/sec FINE    ;
/POS
P[1]{
   GP1:
	UF : 1, UT : 2,		CONFIG : 'N U T, 0, 0, 0',
	X =  1204.000  mm,	Y =  -370.000  mm,	Z =    85.750  mm,
	W =   -89.999 deg,	P =   -90.000 deg,	R =    -0.001 deg
};
P[2]{
   GP1:
	UF : 1, UT : 2,		CONFIG : 'N U T, 0, 0, 0',
	X =  1204.000  mm,	Y =  -340.000  mm,	Z =    85.750  mm,
	W =   -89.999 deg,	P =   -90.000 deg,	R =    -0.001 deg
};
P[3]{
   GP1:
	UF : 1, UT : 2,		CONFIG : 'N U T, 0, 0, 0',
	X =  1204.000  mm,	Y =  -340.062  mm,	Z =   125.750  mm,
	W =   -89.999 deg,	P =   -90.000 deg,	R =    -0.001 deg
};
P[4]{
   GP1:
	UF : 1, UT : 2,		CONFIG : 'N U T, 0, 0, 0',
	X =  1204.008  mm,	Y =  -340.062  mm,	Z =   136.250  mm,
	W =    90.000 deg,	P =    16.260 deg,	R =   180.000 deg
};
P[5]{
   GP1:
	UF : 1, UT : 2,		CONFIG : 'N U T, 0, 0, 0',
	X =  1204.008  mm,	Y =  -340.000  mm,	Z =   176.250  mm,
	W =    90.000 deg,	P =    16.260 deg,	R =   180.000 deg
};
P[6]{
   GP1:
	UF : 1, UT : 2,		CONFIG : 'N U T, 0, 0, 0',
	X =  1204.008  mm,	Y =  -370.000  mm,	Z =   176.250  mm,
	W =    90.000 deg,	P =    16.260 deg,	R =   180.000 deg
};
P[7]{
   GP1:
	UF : 1, UT : 2,		CONFIG : 'N U T, 0, 0, 0',
	X =  1180.000  mm,	Y =  -400.000  mm,	Z =   135.500  mm,
	W =   -89.999 deg,	P =   -90.000 deg,	R =    -0.001 deg
};
P[8]{
   GP1:
	UF : 1, UT : 2,		CONFIG : 'N U T, 0, 0, 0',
	X =  1200.000  mm,	Y =  -365.000  mm,	Z =   125.500  mm,
	W =    90.000 deg,	P =     0.000 deg,	R =    90.000 deg
};
P[9]{
   GP1:
	UF : 1, UT : 2,		CONFIG : 'N U T, 0, 0, 0',
	X =  1200.000  mm,	Y =  -340.000  mm,	Z =   125.500  mm,
	W =    90.000 deg,	P =     0.000 deg,	R =    90.000 deg
};
P[10]{
   GP1:
	UF : 1, UT : 2,		CONFIG : 'N U T, 0, 0, 0',
	X =  1160.000  mm,	Y =  -340.000  mm,	Z =   105.500  mm,
	W =    90.000 deg,	P =     0.000 deg,	R =    90.000 deg
};
P[11]{
   GP1:
	UF : 1, UT : 2,		CONFIG : 'N U T, 0, 0, 0',
	X =  1170.000  mm,	Y =  -340.000  mm,	Z =    35.500  mm,
	W =    90.000 deg,	P =     0.000 deg,	R =  -163.740 deg
};
P[12]{
   GP1:
	UF : 1, UT : 2,		CONFIG : 'N U T, 0, 0, 0',
	X =  1240.000  mm,	Y =  -340.000  mm,	Z =    45.500  mm,
	W =    90.000 deg,	P =     0.000 deg,	R =  -163.740 deg
};
P[13]{
   GP1:
	UF : 1, UT : 2,		CONFIG : 'N U T, 0, 0, 0',
	X =  1230.000  mm,	Y =  -340.000  mm,	Z =   115.500  mm,
	W =    90.000 deg,	P =     0.000 deg,	R =    90.000 deg
};
P[14]{
   GP1:
	UF : 1, UT : 2,		CONFIG : 'N U T, 0, 0, 0',
	X =  1200.000  mm,	Y =  -340.000  mm,	Z =   125.500  mm,
	W =    90.000 deg,	P =     0.000 deg,	R =    90.000 deg
};
P[15]{
   GP1:
	UF : 1, UT : 2,		CONFIG : 'N U T, 0, 0, 0',
	X =  1200.000  mm,	Y =  -365.000  mm,	Z =   125.500  mm,
	W =    90.000 deg,	P =     0.000 deg,	R =    90.000 deg
};
/END
