#!/usr/bin/python3
"""What docs/containers/kubernetes.yaml starts, with network namespaces for Pods: one address each, no multicast, the
discovery servers behind addresses that are translated (as kube-proxy does), each program as process 1, started again when it
ends, and asked by its probes. Not Kubernetes: its API, its scheduler and its images are not in it.
    kubernetes_test.py SOURCE_DIR PROGRAM     about three minutes; exit code 77: not here (needs root, nft, conntrack,
    fastdds-tools)"""

import os
import pathlib
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import time

import container_files as files

SERVICES = {'aurasim-discovery-0': '10.96.0.10', 'aurasim-discovery-1': '10.96.0.11', 'aurasim-viewer': '10.96.0.12'}
KUBELET = '10.73.21.254'
LAB = f'aurakube{os.getpid()}'
BECOMES_SPARE = 'becomes a spare'


def sh(*words, text=None):
    return subprocess.run(words, input=text, text=True, capture_output=True, check=True).stdout


class Pod:
    """A namespace with one address, and in it one process, which is started again whenever it ends."""

    def __init__(self, cluster, process, number):
        self.cluster, self.process, self.netns = cluster, process, f'{LAB}-{number}'
        self.starts, self.unshare, self.log = 0, None, cluster.folder / f'{process.name}.log'
        self.is_wanted = False
        cluster.add_namespace(self.netns, process.address, number)

    def words(self):
        if self.process.image == 'aurasim-discovery':
            return ['fast-discovery-server', *self.process.words]
        config = self.cluster.folder / 'launch.yaml'
        config.write_text(self.process.config.replace('/usr/share/aurasim', str(self.cluster.source)))
        saves = self.cluster.folder / self.process.name
        saves.mkdir(exist_ok=True)
        replaced = {'/etc/aurasim/launch.yaml': str(config), '/var/lib/aurasim': str(saves)}
        return [self.cluster.program, *(replaced.get(word, word) for word in self.process.words)]

    def start(self):
        self.is_wanted = True
        self.starts += 1
        self.unshare = subprocess.Popen(
            ['nsenter', f'--net=/run/netns/{self.netns}', 'unshare', '--pid', '--fork', '--kill-child', '--mount-proc',
             'bash', '-c', 'mount -t tmpfs none /dev/shm && exec "$@"', 'pod', *self.words()],
            stdout=self.log.open('a'), stderr=subprocess.STDOUT, start_new_session=True)

    def pid(self):
        """Of its process 1, as seen from outside."""
        children = pathlib.Path(f'/proc/{self.unshare.pid}/task/{self.unshare.pid}/children').read_text().split()
        return int(children[0]) if children else 0

    def send(self, number):
        os.kill(self.pid(), number)

    def tend(self):
        """As the kubelet."""
        if self.is_wanted and self.unshare.poll() is not None:
            print(f'   {self.process.name} has ended ({self.unshare.returncode}), and is started again')
            self.start()

    def stop(self):
        self.is_wanted = False
        if self.unshare and self.unshare.poll() is None:
            if self.pid():
                self.send(signal.SIGKILL)
            self.unshare.kill()
            self.unshare.wait()

    def asks(self, kind):
        """Does its probe say yes?"""
        probe = self.process.probes[kind]
        if isinstance(probe, dict):
            host = f'{self.process.address}:8080'
            request = f'exec 3<>/dev/tcp/{self.process.address}/8080; printf "GET {probe["path"]} HTTP/1.1\\r\\n' \
                      f'Host: {host}\\r\\nConnection: close\\r\\n\\r\\n" >&3; grep -q "200 OK" <&3'
            words = ['nsenter', f'--net=/run/netns/{LAB}-switch', 'bash', '-c', request]
        else:
            words = ['nsenter', '--target', str(self.pid()), '--pid', '--mount', '--net', *probe]
        return subprocess.run(words, capture_output=True, check=False, timeout=30).returncode == 0

    def has_region(self):
        """Its command line says which role it has now."""
        return b'node' in pathlib.Path(f'/proc/{self.pid()}/cmdline').read_bytes().split(b'\0')

    def said(self):
        return self.log.read_text() if self.log.exists() else ''


class Cluster:
    def __init__(self, source, program, folder):
        self.source, self.program, self.folder = source, program, folder
        sh('ip', 'netns', 'add', f'{LAB}-switch')
        self.ip('switch', 'link', 'set', 'lo', 'up')
        self.ip('switch', 'link', 'add', 'bridge', 'type', 'bridge')
        self.ip('switch', 'address', 'add', f'{KUBELET}/24', 'dev', 'bridge')
        self.ip('switch', 'link', 'set', 'bridge', 'up')
        objects = files.load_kubernetes(source / 'docs/containers')
        processes = files.processes_of_kubernetes(objects, SERVICES)
        self.pods = {p.name: Pod(self, p, i) for i, p in enumerate(processes)}
        self.serve()

    def ip(self, name, *words):
        sh('ip', '-n', f'{LAB}-{name}', *words)

    def add_namespace(self, netns, address, number):
        sh('ip', 'netns', 'add', netns)
        sh('ip', '-n', netns, 'link', 'set', 'lo', 'up')
        sh('ip', 'link', 'add', f'port{number}', 'netns', f'{LAB}-switch', 'type', 'veth', 'peer', 'name', 'eth0', 'netns', netns)
        self.ip('switch', 'link', 'set', f'port{number}', 'master', 'bridge', 'up')
        sh('ip', '-n', netns, 'address', 'add', f'{address}/24', 'dev', 'eth0')
        sh('ip', '-n', netns, 'link', 'set', 'eth0', 'up')
        sh('ip', '-n', netns, 'route', 'add', 'default', 'via', KUBELET)

    def serve(self):
        """The Services of the discovery servers lead to their Pods; nothing is multicast."""
        translated = [(SERVICES[pod.process.service], pod.process.address) for pod in self.pods.values()
                      if pod.process.image == 'aurasim-discovery']
        rules = '\n'.join(f'    ip daddr {service} udp dport {files.DISCOVERY_PORT} dnat to {pod}:{files.DISCOVERY_PORT};'
                          for service, pod in translated)
        for pod in self.pods.values():
            sh('ip', 'netns', 'exec', pod.netns, 'nft', '-f', '-', text=f'''
table ip kube
delete table ip kube
table ip kube {{
  chain services {{
    type nat hook output priority -100;
{rules}
  }}
  chain unicast {{
    type filter hook output priority 0;
    ip daddr 224.0.0.0/4 counter drop;
  }}
}}
''')
            # As kube-proxy does: or what is on its way keeps the old address.
            subprocess.run(['ip', 'netns', 'exec', pod.netns, 'conntrack', '-D', '-p', 'udp'], capture_output=True, check=False)

    def wait(self, what, condition, limit_s=60):
        end = time.monotonic() + limit_s
        begin = time.monotonic()
        while time.monotonic() < end:
            for pod in self.pods.values():
                pod.tend()
            if condition():
                print(f'{what}: after {time.monotonic() - begin:.1f} s')
                return
            time.sleep(0.2)
        self.fail(what)

    def fail(self, what):
        for pod in self.pods.values():
            print(f'--- {pod.process.name}\n{pod.said()[-2500:]}')
        print(self.rows())
        print(f'FAILED: {what}')
        sys.exit(1)

    def expect(self, what, condition):
        if not condition:
            self.fail(what)
        print(what)

    def rows(self):
        """Of `top`, from the viewer's Pod: {region: (state, step, bodies)}."""
        pod = self.pods['aurasim-overseer-0']
        words = pod.words()
        words[1] = 'top'
        run = subprocess.run(['nsenter', f'--net=/run/netns/{pod.netns}', *words, '--duration', '3'], capture_output=True,
                             text=True, check=False)
        return {int(m[1]): (m[2], int(m[3]), int(m[4])) for m in
                re.finditer(r'^ +(\d+) +(\w[\w ]*?) +(\d+) +(\d+)', run.stdout, re.MULTILINE)}

    def runs(self):
        rows = self.rows()
        return sorted(rows) == [0, 1, 2, 3] and all(row[0] == 'running' for row in rows.values())

    def close(self):
        for pod in self.pods.values():
            pod.stop()
        for name in [pod.netns for pod in self.pods.values()] + [f'{LAB}-switch']:
            subprocess.run(['ip', 'netns', 'delete', name], check=False)


def replace(cluster, server, address):
    """By a Pod of the same name: on another machine, so with another address."""
    server.stop()
    time.sleep(3)
    server.process.words = [word.replace(server.process.address, address) for word in server.process.words]
    sh('ip', '-n', server.netns, 'address', 'flush', 'dev', 'eth0')
    sh('ip', '-n', server.netns, 'address', 'add', f'{address}/24', 'dev', 'eth0')
    sh('ip', '-n', server.netns, 'route', 'replace', 'default', 'via', KUBELET)
    server.process.address = address
    server.start()
    cluster.serve()


def play(cluster):
    pods = cluster.pods
    nodes = [pods[f'aurasim-node-{i}'] for i in range(4)]
    spare, overseer = pods['aurasim-spare-0'], pods['aurasim-overseer-0']
    servers = [pods[f'aurasim-discovery-{i}'] for i in range(2)]
    # As they may: the nodes before the servers that they need.
    for pod in [*nodes, spare, overseer, *servers]:
        pod.start()
    cluster.wait('the run goes on', cluster.runs)
    for pod in pods.values():
        for kind in pod.process.probes:
            cluster.expect(f'   {pod.process.name}: {kind} says yes', pod.asks(kind))

    nodes[2].send(signal.SIGKILL)
    cluster.wait('a node is killed: the spare takes its region over', lambda: 'takes over region 2' in spare.said())
    cluster.wait('   and what is started in its place is a spare', lambda: BECOMES_SPARE in nodes[2].said())
    cluster.wait('   and the run goes on', cluster.runs)

    replace(cluster, servers[0], '10.73.21.99')
    cluster.wait('a discovery server is replaced by one with another address, and the run goes on', cluster.runs)

    # As in `kubectl rollout restart`, or an update.
    for pod in [spare, *nodes, overseer]:
        before = pod.starts
        pod.send(signal.SIGTERM)
        cluster.wait(f'{pod.process.name} is told to leave: it is started again', lambda: pod.starts > before)
        cluster.wait('   and the run goes on', cluster.runs)

    replace(cluster, servers[1], '10.73.21.98')
    cluster.wait('the other server is replaced, too, and the run goes on', cluster.runs)

    hung = next(pod for pod in [spare, *nodes] if pod.has_region())
    hung.send(signal.SIGSTOP)
    cluster.expect(f'{hung.process.name} hangs: its livenessProbe says no', not hung.asks('livenessProbe'))
    before = hung.said().count(BECOMES_SPARE)
    hung.send(signal.SIGKILL)  # as the kubelet then does
    if hung in nodes:
        cluster.wait('   and it comes back as a spare', lambda: hung.said().count(BECOMES_SPARE) > before)
    cluster.wait('   and the run goes on', cluster.runs)
    bodies = sum(row[2] for row in cluster.rows().values())
    cluster.expect(f'   with {bodies} bodies', bodies >= 100)


def main():
    source, program = pathlib.Path(sys.argv[1]).resolve(), str(pathlib.Path(sys.argv[2]).resolve())
    missing = [tool for tool in ('ip', 'nft', 'nsenter', 'unshare', 'conntrack', 'fast-discovery-server') if not shutil.which(tool)]
    if os.geteuid() != 0 or missing:
        print('skipped: needs root' if not missing else f'skipped: there is no {missing[0]}')
        sys.exit(77)
    cluster = None
    with tempfile.TemporaryDirectory() as folder:
        try:
            cluster = Cluster(source, program, pathlib.Path(folder))
            play(cluster)
        finally:
            if cluster:
                cluster.close()
    print('passed')


main()
