"""A private Slurm cluster for a test: munged, slurmctld and two slurmd on the loopback interface, without systemd."""

import contextlib
import os
import shutil
import signal
import socket
import subprocess
import tempfile

import live_platoon
from processes import children, processes_with, words_of

PROGRAMS = ("munged", "mungekey", "slurmctld", "slurmd", "sbatch", "scontrol", "squeue", "scancel", "sinfo")
NODES = ("n0", "n1")
PATH = os.pathsep.join([os.environ.get("PATH", ""), "/usr/sbin", "/sbin"])

CONFIGURATION = """
ClusterName=platoon
SlurmctldHost={host}(127.0.0.1)
SlurmUser=root
SlurmctldPort={controller_port}
AuthType=auth/munge
AuthInfo=socket={folder}/munge.socket,cred_expire=5
CredType=cred/munge
CommunicationParameters=NoCtldInAddrAny,NoInAddrAny
ProctrackType=proctrack/pgid
TaskPlugin=task/none
SwitchType=switch/none
MpiDefault=none
JobAcctGatherType=jobacct_gather/none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
SlurmctldParameters=enable_configless
SchedulerParameters=batch_sched_delay=0,sched_interval=2,sched_min_interval=100000
StateSaveLocation={folder}/state
SlurmdSpoolDir={folder}/spool.%n
SlurmctldPidFile={folder}/slurmctld.pid
SlurmdPidFile={folder}/slurmd.%n.pid
SlurmctldLogFile={folder}/slurmctld.log
SlurmdLogFile={folder}/slurmd.%n.log
ReturnToService=2
SlurmdTimeout=6
KillWait=2
"""


def why_not():
    """The reason why no cluster can run here; empty if a cluster can run."""
    missing = [program for program in PROGRAMS if not shutil.which(program, path=PATH)]
    if missing:
        return "needs " + ", ".join(missing) + " (packages slurmctld, slurmd, slurm-client, munge)"
    return "" if os.geteuid() == 0 else "slurmd runs as root only"


class Cluster:
    def __init__(self):
        self.folder = tempfile.mkdtemp(prefix="platoon_slurm_")
        self.mark = "PLATOON_CLUSTER=" + self.folder  # in the environment of all its processes
        os.chmod(self.folder, 0o755)
        self.file = os.path.join(self.folder, "slurm.conf")
        self.environment = dict(os.environ, PATH=PATH, SLURM_CONF=self.file)
        self.daemons = {}

    def write_configuration(self):
        host = socket.gethostname().split(".")[0]
        text = CONFIGURATION.format(host=host, folder=self.folder, controller_port=live_platoon.free_port())
        for node in NODES:
            text += "NodeName={} NodeHostname={} NodeAddr=127.0.0.1 Port={} CPUs=1\n".format(node, host, live_platoon.free_port())
        text += "PartitionName=main Nodes=ALL Default=YES\n"
        with open(self.file, "w") as file:
            file.write(text)
        version = subprocess.run(["slurmd", "-V"], stdout=subprocess.PIPE, text=True, check=True, env=self.environment).stdout.split()[1]
        year = int(version.split(".")[0])
        if year >= 22:  # it looks for control groups even without a plugin that uses them
            with open(os.path.join(self.folder, "cgroup.conf"), "w") as file:
                file.write("CgroupPlugin={}\n".format("cgroup/v1" if year == 22 else "disabled"))

    def daemon(self, name, *command, **environment):
        log = open(os.path.join(self.folder, name + ".out"), "w")
        with log:
            self.daemons[name] = subprocess.Popen(
                command, stdout=log, stderr=subprocess.STDOUT,
                env=dict(self.environment, PLATOON_CLUSTER=self.folder, **environment))

    def start(self):
        self.write_configuration()
        os.mkdir(os.path.join(self.folder, "state"))
        inside = lambda name: os.path.join(self.folder, name)  # noqa: E731
        subprocess.run(["mungekey", "--create", "--keyfile", inside("munge.key")], check=True, env=self.environment)
        self.daemon("munged", "munged", "--foreground", "--force", "--key-file", inside("munge.key"), "--socket", inside("munge.socket"),
                    "--pid-file", inside("munge.pid"), "--log-file", inside("munge.log"), "--seed-file", inside("munge.seed"))
        live_platoon.wait_for(lambda: os.path.exists(inside("munge.socket")) or self.daemons["munged"].poll() is not None, "munged")
        self.daemon("slurmctld", "slurmctld", "-D", "-f", self.file)
        for node in NODES:
            os.mkdir(inside("spool." + node))
            self.daemon(node, "slurmd", "-D", "-f", self.file, "-N", node, PLATOON_NODE=self.folder + "/" + node)
        live_platoon.wait_for(lambda: all(state.startswith("idle") for state in self.states()) and self.states(), "the nodes to be idle", 60.0)

    def run(self, *command, **options):
        done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, universal_newlines=True,
                              env=dict(self.environment, **options.get("environment", {})), timeout=60)
        return done.stdout

    def states(self):
        return [line.strip() for line in self.run("sinfo", "--noheader", "--Node", "--format=%T").splitlines()]

    def jobs(self):
        """(task, state, node) of all pending and running tasks."""
        lines = self.run("squeue", "--noheader", "--array", "--format=%i|%T|%N").splitlines()
        return [tuple(line.strip().split("|")) for line in lines if line.count("|") == 2]

    def power_off(self, node):
        """Kills the node's daemon and all its tasks without notice."""
        # All stop before the first is killed: slurmstepd would report the death of its task, and the job would not be requeued.
        victims, found = set(), self.processes_of(node)
        while found - victims:
            for process in found - victims:
                self.send(process, signal.SIGSTOP)
            victims |= found
            found = self.processes_of(node)
        for process in victims:
            self.send(process, signal.SIGKILL)
        self.daemons[node].wait()

    def processes_of(self, node):
        found = set(processes_with("PLATOON_NODE=" + self.folder + "/" + node)) | (
            set(processes_with("SLURMD_NODENAME=" + node)) & set(processes_with("SLURM_CONF=" + self.file)))
        # Slurm 24 removes the environment of slurmstepd.
        return found | {process for process in map(int, filter(str.isdigit, os.listdir("/proc")))
                        if "".join(words_of(process)).startswith("slurmstepd") and found.intersection(children(process))}

    @staticmethod
    def send(process, number):
        with contextlib.suppress(ProcessLookupError):
            os.kill(process, number)

    def end(self):
        if "slurmctld" in self.daemons and self.daemons["slurmctld"].poll() is None:
            self.run("scancel", "--user=root")
        for name in NODES + ("slurmctld", "munged"):
            daemon = self.daemons.get(name)
            if daemon and daemon.poll() is None:
                daemon.terminate()
                try:
                    daemon.wait(timeout=20)
                except subprocess.TimeoutExpired:
                    daemon.kill()
                    daemon.wait()
        for process in set(processes_with(self.mark)) | set(processes_with("SLURM_CONF=" + self.file)):
            self.send(process, signal.SIGKILL)
        shutil.rmtree(self.folder, ignore_errors=True)

    def logs(self):
        text = ""
        for name in sorted(os.listdir(self.folder)):
            if name.endswith((".log", ".out")):
                with open(os.path.join(self.folder, name), errors="replace") as file:
                    text += "== {}\n{}\n".format(name, file.read()[-3000:])
        return text
