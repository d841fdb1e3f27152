/PROG  ARM
/ATTR
OWNER		= MNEDITOR;
COMMENT		= "Seampath";
PROG_SIZE	= 0;
CREATE		= DATE 70-01-01  TIME 00:00:00;
MODIFIED	= DATE 70-01-01  TIME 00:00:00;
FILE_NAME	= ;
VERSION		= 0;
LINE_COUNT	= 35;
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
   7:  !Moves stay within 0.0157 mm of ;
   8:  !the seam. ;
   9:  !Axes are those of Arm 6 standing ;
  10:  !in that base. ;
  11:  !Positions are rounded by up to ;
  12:  !0.0005 mm. ;
  13:  !Units: mm, deg, W, P, R about X, ;
  14:  !Y, Z. ;
  15:  UFRAME_NUM=1 ;
  16:  UTOOL_NUM=2 ;
  17:J P[1] 10% FINE    ;
  18:L P[2] 100mm/sec FINE
    :  Arc Start[6]    ;
  19:  Weave Sine[8] ;
  20:L P[3] 51cm/min CNT100    ;
  21:L P[4] 51cm/min CNT100    ;
  22:L P[5] 51cm/min FINE
    :  Arc End[7]    ;
  23:  Weave End ;
  24:L P[6] 100mm/sec FINE    ;
  25:J P[7] 10% FINE    ;
  26:J P[8] 10% FINE    ;
  27:L P[9] 100mm/sec FINE
    :  Arc Start[6]    ;
  28:  Weave Sine[8] ;
  29:L P[10] 12mm/sec CNT100    ;
  30:L P[11] 12mm/sec CNT100    ;
  31:L P[12] 12mm/sec CNT100    ;
  32:L P[13] 12mm/sec CNT100    ;
  33:L P[14] 12mm/sec FINE
    :  Arc End[7]    ;
  34:  Weave End ;
  35:L P[15] 100mm/sec FINE    ;
/POS
P[1]{
   GP1:
	UF : 1, UT : 2,	
	J1=     0.000 deg,	J2=   -28.648 deg,	J3=   114.592 deg,
	J4=   -14.324 deg,	J5=   -71.620 deg,	J6=     0.000 deg
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
	UF : 1, UT : 2,	
	J1=    42.972 deg,	J2=    14.324 deg,	J3=    28.648 deg,
	J4=   -14.324 deg,	J5=   -50.134 deg,	J6=   -42.972 deg
};
P[8]{
   GP1:
	UF : 1, UT : 2,	
	J1=    50.134 deg,	J2=    21.486 deg,	J3=    14.324 deg,
	J4=   -14.324 deg,	J5=   -46.553 deg,	J6=   -50.134 deg
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
