"""FILE=PROGRAM.ngc freecadcmd freecad_path.py: reads a program with FreeCAD's Path workbench and prints each G1 with its
X, Y, Z, A, B, C and the feed in force. FreeCAD takes comments in parentheses only: those behind a semicolon are left out."""
import os
import Path

lines = [line for line in open(os.environ['FILE']).read().splitlines() if not line.startswith(';')]
feed = 0
for command in Path.Path('\n'.join(lines)).Commands:
    feed = command.Parameters.get('F', feed)
    if command.Name == 'G1':
        print('G1', *[repr(command.Parameters[axis]) for axis in 'XYZABC'], repr(feed), flush=True)
