/PROG  GOLDEN
/ATTR
OWNER		= MNEDITOR;
COMMENT		= "Seampath";
PROG_SIZE	= 0;
CREATE		= DATE 70-01-01  TIME 00:00:00;
MODIFIED	= DATE 70-01-01  TIME 00:00:00;
FILE_NAME	= ;
VERSION		= 0;
LINE_COUNT	= 29;
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
/MN
   1:  !Written by Seampath. ;
   2:  !Frame: robot base, ;
   3:  !base_from_scan is 0 0 0 mm, ;
   4:  !quaternion w x y z 1 0 0 0. ;
   5:  !Tool: +Z along the torch into ;
   6:  !the joint, +X along travel. ;
   7:  !Moves stay within 0.0157 mm of ;
   8:  !the seam. ;
   9:  !Positions are rounded by up to ;
  10:  !0.0005 mm. ;
  11:  !Units: mm, deg, W, P, R about X, ;
  12:  !Y, Z. ;
  13:  UFRAME_NUM=1 ;
  14:  UTOOL_NUM=2 ;
  15:J P[1] 10% FINE    ;
  16:L P[2] 100mm/sec FINE    ;
  17:L P[3] 51cm/min CNT100    ;
  18:L P[4] 51cm/min CNT100    ;
  19:L P[5] 51cm/min FINE    ;
  20:L P[6] 100mm/sec FINE    ;
  21:L P[7] 250mm/sec FINE    ;
  22:L P[8] 250mm/sec FINE    ;
  23:L P[9] 100mm/sec FINE    ;
  24:L P[10] 12mm/sec CNT100    ;
  25:L P[11] 12mm/sec CNT100    ;
  26:L P[12] 12mm/sec CNT100    ;
  27:L P[13] 12mm/sec CNT100    ;
  28:L P[14] 12mm/sec FINE    ;
  29:L P[15] 100mm/sec FINE    ;
/POS
P[1]{
   GP1:
	UF : 1, UT : 2,		CONFIG : 'N U T, 0, 0, 0',
	X =    10.250  mm,	Y =    -4.000  mm,	Z =    30.000  mm,
	W =   180.000 deg,	P =     0.000 deg,	R =     0.000 deg
};
P[2]{
   GP1:
	UF : 1, UT : 2,		CONFIG : 'N U T, 0, 0, 0',
	X =    10.250  mm,	Y =    -4.000  mm,	Z =     0.000  mm,
	W =   180.000 deg,	P =     0.000 deg,	R =     0.000 deg
};
P[3]{
   GP1:
	UF : 1, UT : 2,		CONFIG : 'N U T, 0, 0, 0',
	X =    50.250  mm,	Y =    -4.000  mm,	Z =     0.062  mm,
	W =   180.000 deg,	P =     0.000 deg,	R =     0.000 deg
};
P[4]{
   GP1:
	UF : 1, UT : 2,		CONFIG : 'N U T, 0, 0, 0',
	X =    60.750  mm,	Y =    -4.008  mm,	Z =     0.062  mm,
	W =   180.000 deg,	P =     0.000 deg,	R =   106.260 deg
};
P[5]{
   GP1:
	UF : 1, UT : 2,		CONFIG : 'N U T, 0, 0, 0',
	X =   100.750  mm,	Y =    -4.008  mm,	Z =     0.000  mm,
	W =   180.000 deg,	P =     0.000 deg,	R =   106.260 deg
};
P[6]{
   GP1:
	UF : 1, UT : 2,		CONFIG : 'N U T, 0, 0, 0',
	X =   100.750  mm,	Y =    -4.008  mm,	Z =    30.000  mm,
	W =   180.000 deg,	P =     0.000 deg,	R =   106.260 deg
};
P[7]{
   GP1:
	UF : 1, UT : 2,		CONFIG : 'N U T, 0, 0, 0',
	X =    60.000  mm,	Y =    20.000  mm,	Z =    60.000  mm,
	W =   180.000 deg,	P =     0.000 deg,	R =     0.000 deg
};
P[8]{
   GP1:
	UF : 1, UT : 2,		CONFIG : 'N U T, 0, 0, 0',
	X =    50.000  mm,	Y =     0.000  mm,	Z =    25.000  mm,
	W =    89.999 deg,	P =    90.000 deg,	R =    -0.001 deg
};
P[9]{
   GP1:
	UF : 1, UT : 2,		CONFIG : 'N U T, 0, 0, 0',
	X =    50.000  mm,	Y =     0.000  mm,	Z =     0.000  mm,
	W =    89.999 deg,	P =    90.000 deg,	R =    -0.001 deg
};
P[10]{
   GP1:
	UF : 1, UT : 2,		CONFIG : 'N U T, 0, 0, 0',
	X =    30.000  mm,	Y =    40.000  mm,	Z =     0.000  mm,
	W =    89.999 deg,	P =    90.000 deg,	R =    -0.001 deg
};
P[11]{
   GP1:
	UF : 1, UT : 2,		CONFIG : 'N U T, 0, 0, 0',
	X =   -40.000  mm,	Y =    30.000  mm,	Z =     0.000  mm,
	W =   180.000 deg,	P =   -16.260 deg,	R =    90.000 deg
};
P[12]{
   GP1:
	UF : 1, UT : 2,		CONFIG : 'N U T, 0, 0, 0',
	X =   -30.000  mm,	Y =   -40.000  mm,	Z =     0.000  mm,
	W =   180.000 deg,	P =   -16.260 deg,	R =    90.000 deg
};
P[13]{
   GP1:
	UF : 1, UT : 2,		CONFIG : 'N U T, 0, 0, 0',
	X =    40.000  mm,	Y =   -30.000  mm,	Z =     0.000  mm,
	W =    89.999 deg,	P =    90.000 deg,	R =    -0.001 deg
};
P[14]{
   GP1:
	UF : 1, UT : 2,		CONFIG : 'N U T, 0, 0, 0',
	X =    50.000  mm,	Y =     0.000  mm,	Z =     0.000  mm,
	W =    89.999 deg,	P =    90.000 deg,	R =    -0.001 deg
};
P[15]{
   GP1:
	UF : 1, UT : 2,		CONFIG : 'N U T, 0, 0, 0',
	X =    50.000  mm,	Y =     0.000  mm,	Z =    25.000  mm,
	W =    89.999 deg,	P =    90.000 deg,	R =    -0.001 deg
};
/END
