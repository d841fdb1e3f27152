#!/usr/bin/python3
"""ros_messages.py POSES.yaml TRAJECTORY.yaml [JOINTS.yaml]: fills ROS messages of Debian's packages from the files, as
"rostopic pub" does, and prints how many poses and points they hold. Debian has ROS 1, whose durations are of secs and
nsecs."""
import sys
import yaml
import genpy
from geometry_msgs.msg import PoseArray
from trajectory_msgs.msg import JointTrajectory, MultiDOFJointTrajectory


def filled(message, file):
    content = yaml.safe_load(open(file))
    for point in content.get('points', []):
        time = point['time_from_start']
        point['time_from_start'] = {'secs': time['sec'], 'nsecs': time['nanosec']}
    genpy.message.fill_message_args(message, [content])
    message._check_types()
    return message


poses = filled(PoseArray(), sys.argv[1])
trajectory = filled(MultiDOFJointTrajectory(), sys.argv[2])
print('poses', len(poses.poses), 'points', len(trajectory.points), 'frame', poses.header.frame_id)
last = trajectory.points[-1]
print('last', repr(last.transforms[0].translation.x), repr(last.transforms[0].rotation.w), last.time_from_start.to_nsec())
if len(sys.argv) > 3:
    joints = filled(JointTrajectory(), sys.argv[3])
    print('joints', *joints.joint_names, 'points', len(joints.points))
    print('axes', *[repr(angle) for angle in joints.points[-1].positions])
    times = [point.time_from_start.to_nsec() for point in joints.points]
    assert all(a < b for a, b in zip(times, times[1:])) and times[-1] == last.time_from_start.to_nsec()
    assert all(len(point.velocities) == len(joints.joint_names) for point in joints.points)
