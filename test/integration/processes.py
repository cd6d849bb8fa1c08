"""What the system knows of processes: children, environment, sockets, memory."""

import glob
import os
import re

PAGE = os.sysconf("SC_PAGE_SIZE")


def children(process):
    """Process ids of the children of a process, started by any of its threads."""
    found = []
    for file in glob.glob("/proc/{}/task/*/children".format(process)):
        try:
            with open(file) as listed:
                found += [int(word) for word in listed.read().split()]
        except OSError:
            pass  # the thread has ended
    return found


def descendants(process):
    """Process ids of a process and all its descendants."""
    return [process] + [below for child in children(process) for below in descendants(child)]


def words_of(process):
    """The command line of a process; empty if the process has ended."""
    try:
        with open("/proc/{}/cmdline".format(process)) as file:
            return file.read().split("\0")
    except OSError:
        return []


def node_of(process):
    """The name of the ROS node of a process, without its namespace; None if it has none."""
    return next((word[len("__name:="):] for word in words_of(process) if word.startswith("__name:=")), None)


def nodes(*launches):
    """Process ids, by node name, of the nodes that these roslaunch processes have started."""
    started = [process for launch in launches for process in children(launch)]
    return {node_of(process): process for process in started if node_of(process)}


def processes_with(word):
    """Ids of the processes with this word in their environment."""
    found = []
    for name in os.listdir("/proc"):
        try:
            with open("/proc/{}/environ".format(name), "rb") as file:
                if word.encode() in file.read().split(b"\0"):
                    found.append(int(name))
        except (OSError, ValueError):
            continue
    return found


def footprint(process):
    """Resident memory [bytes] and number of open descriptors; None if the process has ended."""
    try:
        with open("/proc/{}/statm".format(process)) as file:
            resident = int(file.read().split()[1]) * PAGE
        return resident, len(os.listdir("/proc/{}/fd".format(process)))
    except OSError:
        return None


def listening(process):
    """(address, port) of every TCP socket that a process listens on; the address is "this machine" or "everywhere"."""
    own = set()
    for link in glob.glob("/proc/{}/fd/*".format(process)):
        try:
            own.update(re.findall(r"socket:\[(\d+)\]", os.readlink(link)))
        except OSError:
            pass
    found = []
    for family in ("tcp", "tcp6"):
        with open("/proc/{}/net/{}".format(process, family)) as table:
            for line in table.readlines()[1:]:
                columns = line.split()
                if columns[3] != "0A" or columns[9] not in own:
                    continue
                address, port = columns[1].split(":")
                loopback = address in ("0100007F", "00000000000000000000000001000000")
                found.append(("this machine" if loopback else "everywhere", int(port, 16)))
    return sorted(found)
