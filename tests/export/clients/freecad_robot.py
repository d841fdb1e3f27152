"""FILE=PROGRAM.dat freecadcmd freecad_robot.py: sets the axes of FreeCAD's KUKA KR 16 to each E6AXIS of a program's data
list, in their order, and prints where its flange then is: x, y, z mm, quaternion x, y, z, w."""
import os
import re
import FreeCAD

robot = FreeCAD.newDocument().addObject('Robot::RobotObject', 'robot')
robot.RobotKinematicFile = os.path.join(FreeCAD.getHomePath(), 'Mod', 'Robot', 'Lib', 'Kuka', 'kr_16.csv')
for text in re.findall(r'DECL E6AXIS \w+=\{(.*)\}', open(os.environ['FILE']).read()):
    for axis in text.split(','):
        name, degrees = axis.split()
        setattr(robot, 'Axis' + name[1], float(degrees))
    robot.Document.recompute()
    print('flange', *[repr(number) for number in (*robot.Tcp.Base, *robot.Tcp.Rotation.Q)], flush=True)
