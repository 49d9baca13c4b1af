#!/usr/bin/python3
"""docs/containers/ and docs/systemd/ say what the program understands, and fit together: options, keys, files, addresses,
ports, names. Each check is shown to fail on a file that is wrong.   files_test.py SOURCE_DIR PROGRAM"""

import copy
import functools
import pathlib
import re
import subprocess
import sys
import tempfile

import container_files as files

SERVICES = {'aurasim-discovery-0': '10.96.0.10', 'aurasim-discovery-1': '10.96.0.11', 'aurasim-viewer': '10.96.0.12'}
INSTALLED = '/usr/share/aurasim'


class Program:
    def __init__(self, source, program):
        self.source, self.program = source, program

    @functools.cache
    def help_of(self, command):
        run = subprocess.run([self.program, command, '--help'], capture_output=True, text=True, check=False)
        return run.stdout if run.returncode == 0 else None

    def here(self, text):
        """What is installed lies in the source tree."""
        return text.replace(INSTALLED, str(self.source))

    def check(self, launch, config, sets):
        with tempfile.TemporaryDirectory() as folder:
            if config:
                launch = folder + '/launch.yaml'
                pathlib.Path(launch).write_text(self.here(config))
            words = [self.program, 'check', launch]
            for text in sets:
                words += ['--set', self.here(text)]
            run = subprocess.run(words, capture_output=True, text=True, check=False)
        regions = re.search(r'(\d+) regions', run.stdout)
        return run.returncode, int(regions[1]) if regions else 0, run.stdout + run.stderr


def check_words(program, where, words, config=''):
    """Of a process of aurasim: its command, its options, its launch file and every --set."""
    errors = []
    said = program.help_of(words[0])
    if said is None:
        return [f'{where}: there is no command {words[0]}']
    options = re.findall(r'--[\w-]+', said)
    errors += [f'{where}: {words[0]} has no {word}' for word in words[1:]
               if word.startswith('--') and word.split('=')[0] not in options]
    code, _, text = program.check(words[1], config, files.sets_of(words))
    if code != 0:
        errors.append(f'{where}: its launch file is refused: {text.strip()}')
    return errors


def check_regions(program, where, processes):
    """Each region has one node, and knows its own address."""
    errors = []
    nodes = [p for p in processes if p.words[0] == 'node']
    regions = sorted(int(files.value_of(p.words, '--region')) for p in nodes)
    _, count, _ = program.check(nodes[0].words[1], nodes[0].config, files.sets_of(nodes[0].words))
    if regions != list(range(count)):
        errors.append(f'{where}: the launch file has {count} regions, the nodes have {regions}')
    for process in processes:
        if process.image != 'aurasim':
            continue
        if files.set_value(process.words, 'dds.interfaces') != [process.address]:
            errors.append(f'{where}: {process.name} has the address {process.address}, and opens another one')
    for process in nodes:
        if '--or-spare' not in process.words:
            errors.append(f'{where}: {process.name} would begin the run anew when it is started again')
    return errors


def check_compose(program, compose):
    processes = files.processes_of_compose(compose)
    errors = []
    for process in processes:
        errors += check_words(program, process.name, process.words)
        if not process.probes:
            errors.append(f'{process.name} has no healthcheck')
    errors += check_regions(program, 'compose.yaml', processes)
    for name, service in compose['services'].items():
        if service['networks'] != ['world']:
            errors.append(f'{name} opens DDS to other networks than the world\'s')
    errors += check_viewer(program, processes, compose['services']['overseer'])
    return errors


def check_viewer(program, processes, service):
    errors = []
    overseer = next(p for p in processes if p.words[0] == 'overseer')
    port = files.value_of(overseer.words, '--port')
    if [entry.split(':')[-1] for entry in service['ports']] != [port]:
        errors.append(f'the viewer listens on {port}, published is {service["ports"]}')
    if not all(entry.startswith('127.0.0.1:') for entry in service['ports']):
        errors.append('the viewer is published to others than this machine')
    probe = ' '.join(overseer.probes['healthcheck'])
    errors += check_path(program, (re.search(r'GET (\S+)', probe) or [None, ''])[1])
    if f'/dev/tcp/127.0.0.1/{port};' not in probe:
        errors.append('the healthcheck of the viewer asks another port')
    return errors


def check_path(program, path):
    hub = (program.source / 'src/overseer/web_hub.cpp').read_text()
    return [] if f'path == "{path}"' in hub else [f'the viewer has no {path}']


def check_kubernetes(program, objects):
    try:
        processes = files.processes_of_kubernetes(objects, SERVICES)
    except (files.UnknownVariable, KeyError) as error:
        return [f'kubernetes.yaml: nobody says what {error} is']
    errors = []
    servers = [p for p in processes if p.image == 'aurasim-discovery']
    if [files.value_of(p.words, '-i') for p in servers] != ['0', '1'] or not all(p.service for p in servers):
        errors.append('the discovery servers have other numbers, or no Service leads to one')
    for process in processes:
        if process.image == 'aurasim':
            errors += check_words(program, process.name, process.words, process.config)
            if files.set_value(process.words, 'dds.peers') != [SERVICES.get(server.service) for server in servers]:
                errors.append(f'{process.name} does not ask the discovery servers, in the order of their numbers')
    errors += check_regions(program, 'kubernetes.yaml', [p for p in processes if p.image == 'aurasim'])
    errors += check_references(objects) + check_ports(program, objects, processes)
    return errors


def check_references(objects):
    """What one object names, another is."""
    errors = []
    for workload in files.workloads(objects):
        name, spec = workload['metadata']['name'], workload['spec']
        labels = spec['template']['metadata']['labels']
        if not spec['selector']['matchLabels'].items() <= labels.items():
            errors.append(f'{name} does not select its own Pods')
        if workload['kind'] == 'StatefulSet' and not files.named(objects, 'Service', spec['serviceName']):
            errors.append(f'{name}: there is no Service {spec["serviceName"]}')
        pod = spec['template']['spec']
        volumes = {volume['name']: volume for volume in pod.get('volumes', [])}
        for volume in volumes.values():
            if 'configMap' in volume and not files.named(objects, 'ConfigMap', volume['configMap']['name']):
                errors.append(f'{name}: there is no ConfigMap {volume["configMap"]["name"]}')
        for container in pod['containers']:
            for mount in container.get('volumeMounts', []):
                if mount['name'] not in volumes:
                    errors.append(f'{name}: there is no volume {mount["name"]}')
            for kind in ('readinessProbe', 'livenessProbe'):
                if kind not in container:
                    errors.append(f'{name} has no {kind}')
    templates = [w['spec']['template']['metadata']['labels'] | {
                     'statefulset.kubernetes.io/pod-name': f'{w["metadata"]["name"]}-{ordinal}'}
                 for w in files.workloads(objects) for ordinal in range(w['spec']['replicas'])]
    for item in objects:
        spec = item.get('spec', {})
        wanted = {'Service': lambda s: s['selector'], 'PodDisruptionBudget': lambda s: s['selector']['matchLabels'],
                  'NetworkPolicy': lambda s: s['podSelector']['matchLabels']}.get(item['kind'])
        if wanted and not any(wanted(spec).items() <= labels.items() for labels in templates):
            errors.append(f'{item["kind"]} {item["metadata"]["name"]} selects no Pod')
    return errors


def check_ports(program, objects, processes):
    errors = []
    for process in processes:
        behind = process.service and files.named(objects, 'Service', process.service)['spec']['ports'][0]
        if process.image == 'aurasim-discovery' and behind and \
                not files.value_of(process.words, '-p') == str(behind['targetPort']) == str(behind['port']):
            errors.append('the discovery server and its Service have different ports')
        if process.image == 'aurasim-discovery':
            hexadecimal = f':{int(files.value_of(process.words, "-p")):04X} '
            errors += [f'{kind} of the discovery server looks for another port' for kind, words in process.probes.items()
                       if hexadecimal not in words]
        for probe in process.probes.values():
            if isinstance(probe, dict):
                errors += check_path(program, probe['path'])
    overseer = files.named(objects, 'Deployment', 'aurasim-overseer')['spec']['template']['spec']['containers'][0]
    port = overseer['ports'][0]['containerPort']
    if f'port: {port}' not in files.named(objects, 'ConfigMap', 'aurasim-world')['data']['launch.yaml']:
        errors.append(f'the viewer does not listen on {port}')
    if files.named(objects, 'NetworkPolicy', 'aurasim-viewer')['spec']['ingress'][0]['ports'][0]['port'] != port:
        errors.append('the NetworkPolicy lets nobody reach the viewer')
    return errors


def check_models(objects):
    """Against the types of Kubernetes's own API, as its Python client has them."""
    try:
        from kubernetes.client import models
    except ImportError:
        print('kubernetes.yaml: not held to the API\'s types, since python3-kubernetes is not installed')
        return []
    versions = {'apps/v1': 'V1', 'v1': 'V1', 'policy/v1': 'V1', 'networking.k8s.io/v1': 'V1'}
    errors = []
    for item in objects:
        name = versions.get(item['apiVersion'], '?') + item['kind']
        errors += check_type(models, name, item, f'{item["kind"]} {item["metadata"]["name"]}')
    return errors


def check_type(models, name, value, where):
    for pattern, parts in ((r'list\[(.*)\]', lambda v: enumerate(v)), (r'dict\(\w+, (.*)\)', lambda v: v.items())):
        inner = re.fullmatch(pattern, name)
        if inner:
            if not isinstance(value, (list, dict)):
                return [f'{where}: {name} expected']
            return [e for key, part in parts(value) for e in check_type(models, inner[1], part, f'{where}.{key}')]
    plain = {'str': str, 'int': int, 'bool': bool, 'float': (int, float), 'object': (str, int, dict)}
    if name in plain:
        return [] if isinstance(value, plain[name]) else [f'{where}: found {value!r}, wanted {name}']
    model = getattr(models, name, None)
    if model is None:
        return [f'{where}: there is no {name}']
    if not isinstance(value, dict):
        return [f'{where}: {name} expected']
    fields = {given: own for own, given in model.attribute_map.items()}
    errors = [f'{where}: {name} has no {key}' for key in value if key not in fields]
    for key, part in value.items():
        if key in fields:
            errors += check_type(models, model.openapi_types[fields[key]], part, f'{where}.{key}')
    return errors


def check_units(program):
    errors = []
    folder = program.source / 'docs/systemd'
    environment = dict(re.findall(r'^(\w+)=(.*)$', (folder / 'node.env').read_text(), re.MULTILINE))
    for unit in sorted(folder.glob('*.service')):
        line = re.search(r'^ExecStart=/usr/bin/aurasim (.*)$', unit.read_text(), re.MULTILINE)[1].replace('%i', '0')
        for name, value in environment.items():
            line = line.replace('${' + name + '}', value).replace('$' + name, value)
        words = line.split()
        words = [word for i, word in enumerate(words)
                 if not word.startswith('dds.security=') and words[i:i + 2][-1:] != ['dds.security=/etc/aurasim/keys']]
        errors += check_words(program, unit.name, words)
    return errors


def without(errors, what):
    if errors:
        print(f'FAILED: {what}:', *errors, sep='\n  ')
    return len(errors)


def expect_errors(check, document, spoil, what):
    """A check that cannot fail is none."""
    spoilt = copy.deepcopy(document)
    spoil(spoilt)
    if check(spoilt):
        return 0
    print(f'FAILED: {what} is not noticed')
    return 1


def container_of(objects, kind, name):
    return files.named(objects, kind, name)['spec']['template']['spec']['containers'][0]


def main():
    program = Program(pathlib.Path(sys.argv[1]).resolve(), sys.argv[2])
    folder = program.source / 'docs/containers'
    compose, objects = files.load_compose(folder), files.load_kubernetes(folder)
    failures = without(check_compose(program, compose), 'compose.yaml')
    failures += without(check_kubernetes(program, objects), 'kubernetes.yaml')
    failures += without(check_models(objects), 'kubernetes.yaml')
    failures += without(check_units(program), 'docs/systemd')

    of_compose = functools.partial(check_compose, program)
    spoil_node = lambda change: lambda c: change(c['services']['node-2']['command'])
    for what, spoil in {
        'an option that there is not': spoil_node(lambda words: words.append('--reigon')),
        'a key that there is not': spoil_node(lambda words: words.extend(['--set', 'dds.peer=[1.2.3.4]'])),
        'a region twice': spoil_node(lambda words: words.__setitem__(words.index('2'), '1')),
        'another network': lambda c: c['services']['node-2'].update(networks=['world', 'default']),
        'a node that nobody hears': spoil_node(lambda words: words.__setitem__(-1, 'dds.interfaces=[127.0.0.1]')),
        'a node that begins anew': spoil_node(lambda words: words.remove('--or-spare')),
        'another port': lambda c: c['services']['overseer'].update(ports=['127.0.0.1:8080:8081']),
    }.items():
        failures += expect_errors(of_compose, compose, spoil, 'compose.yaml: ' + what)
    of_kubernetes = functools.partial(check_kubernetes, program)
    for what, spoil in {
        'a variable that nobody sets': lambda o: container_of(o, 'StatefulSet', 'aurasim-node')['env'].pop(),
        'a Service of another name': lambda o: files.named(o, 'Service', 'aurasim-pods')['metadata'].update(name='x'),
        'replicas for other regions': lambda o: files.named(o, 'StatefulSet', 'aurasim-node')['spec'].update(replicas=3),
        'a path that there is not': lambda o: container_of(o, 'Deployment', 'aurasim-overseer')['livenessProbe'][
            'httpGet'].update(path='/health'),
        'labels that nobody has': lambda o: files.named(o, 'Service', 'aurasim-viewer')['spec']['selector'].update(role='x'),
        'a port that nobody listens on': lambda o: container_of(o, 'StatefulSet', 'aurasim-discovery')['args'].__setitem__(
            -1, '11812'),
        'servers in another order': lambda o: files.named(o, 'Service', 'aurasim-discovery-0')['spec']['selector'].update(
            {'statefulset.kubernetes.io/pod-name': 'aurasim-discovery-1'}),
    }.items():
        failures += expect_errors(of_kubernetes, objects, spoil, 'kubernetes.yaml: ' + what)
    print(f'{failures} failures')
    sys.exit(1 if failures else 0)


main()
