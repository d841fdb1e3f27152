#!/usr/bin/python3
"""Stands in for LinuxCNC's screen: powers on, homes, runs PROGRAM, and has halsampler write LOG meanwhile."""
import os
import subprocess
import time
import linuxcnc

command, status, errors = linuxcnc.command(), linuxcnc.stat(), linuxcnc.error_channel()


def wait_for(ready, seconds):
    end = time.time() + seconds
    while time.time() < end:
        try:
            status.poll()
            if ready():
                return True
        except linuxcnc.error:
            pass
        time.sleep(0.02)
    return False


def do(call, *arguments):
    call(*arguments)
    command.wait_complete()


def run():
    if not wait_for(lambda: True, 20):
        return 'the controller does not answer'
    do(command.state, linuxcnc.STATE_ESTOP_RESET)
    do(command.state, linuxcnc.STATE_ON)
    do(command.mode, linuxcnc.MODE_MANUAL)
    do(command.teleop_enable, 0)
    command.home(-1)
    if not wait_for(lambda: all(status.homed[:6]), 20):
        return 'the arm does not home'
    do(command.mode, linuxcnc.MODE_AUTO)
    do(command.program_open, os.environ['PROGRAM'])
    command.auto(linuxcnc.AUTO_RUN, 0)
    if not wait_for(lambda: status.interp_state != linuxcnc.INTERP_IDLE, 10):
        return 'the program does not start'
    if not wait_for(lambda: status.interp_state == linuxcnc.INTERP_IDLE and status.inpos, 100):
        return 'the program does not end'
    time.sleep(0.3)
    # A busy machine is late now and then: the controller's clock stands still meanwhile, and the arm with it.
    told = [text for _, text in iter(errors.poll, None) if 'delay' not in text]
    return '; '.join(told)


with open(os.environ['LOG'], 'w') as log:
    sampler = subprocess.Popen(['halsampler', '-t'], stdout=log)
    trouble = run()
    sampler.terminate()
    sampler.wait()
print('error ' + trouble if trouble else 'ran to the end', flush=True)
