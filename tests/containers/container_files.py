"""What docs/containers/ starts: every process with its words, its environment and its probes."""

import dataclasses
import pathlib
import re

import yaml

DISCOVERY_PORT = 11811


@dataclasses.dataclass
class Process:
    name: str
    image: str
    words: list          # without the image's entry point, as its container gets them
    address: str = ''
    probes: dict = dataclasses.field(default_factory=dict)  # by name; words, or {'path', 'port'} of an HTTP request
    config: str = ''     # its launch.yaml, if it has one of its own
    service: str = ''    # that it waits behind


def sets_of(words):
    return [words[i + 1] for i, word in enumerate(words) if word == '--set']


def value_of(words, option):
    return words[words.index(option) + 1] if option in words else None


def set_value(words, key):
    """Of --set KEY=..., as YAML."""
    found = [text.split('=', 1)[1] for text in sets_of(words) if text.split('=', 1)[0] == key]
    return yaml.safe_load(found[-1]) if found else None


def load_compose(folder):
    return yaml.safe_load((pathlib.Path(folder) / 'compose.yaml').read_text())


def load_kubernetes(folder):
    return list(yaml.safe_load_all((pathlib.Path(folder) / 'kubernetes.yaml').read_text()))


def processes_of_compose(compose):
    processes = []
    for name, service in compose['services'].items():
        probe = [word.replace('$$', '$') for word in service.get('healthcheck', {}).get('test', [])]
        processes.append(Process(name=name, image=service['image'], words=service['command'],
                                 address='*',
                                 probes={'healthcheck': probe[1:]} if probe else {}))
    return processes


def named(objects, kind, name):
    found = [o for o in objects if o['kind'] == kind and o['metadata']['name'] == name]
    return found[0] if found else None


def workloads(objects):
    return [o for o in objects if o['kind'] in ('StatefulSet', 'Deployment')]


def services_of(objects, labels):
    return [o for o in objects if o['kind'] == 'Service' and o['spec']['selector'].items() <= labels.items()]


class UnknownVariable(Exception):
    pass


def expand(word, environment):
    """As Kubernetes does: $(NAME); what it does not know it leaves as it is, which here is an error."""
    def value(match):
        if match[1] not in environment:
            raise UnknownVariable(f'{match[0]} of "{word}"')
        return environment[match[1]]
    return re.sub(r'\$\((\w+)\)', value, word)


def fields_of_pod(address, ordinal):
    return {'status.podIP': address, "metadata.labels['apps.kubernetes.io/pod-index']": str(ordinal)}


def processes_of_kubernetes(objects, service_addresses):
    """One for each replica, at addresses that are made up. service_addresses: the cluster's, by name of the Service."""
    processes = []
    from_services = {re.sub(r'\W', '_', name).upper() + '_SERVICE_HOST': address
                     for name, address in service_addresses.items()}
    for workload in workloads(objects):
        template = workload['spec']['template']
        pod = template['spec']
        for ordinal in range(workload['spec']['replicas']):
            address = f'10.73.21.{len(processes) + 1}'
            for container in pod['containers']:
                fields = fields_of_pod(address, ordinal)
                environment = dict(from_services)
                for entry in container.get('env', []):
                    reference = entry.get('valueFrom', {})
                    if 'fieldRef' in reference:
                        environment[entry['name']] = fields[reference['fieldRef']['fieldPath']]
                    elif 'value' in entry:
                        environment[entry['name']] = entry['value']
                mapped = [named(objects, 'ConfigMap', volume['configMap']['name'])
                          for volume in pod.get('volumes', []) if 'configMap' in volume]
                labels = template['metadata']['labels'] | {
                    'statefulset.kubernetes.io/pod-name': f'{workload["metadata"]["name"]}-{ordinal}'}
                behind = [s['metadata']['name'] for s in services_of(objects, labels)
                          if s['spec'].get('clusterIP') != 'None']
                processes.append(Process(
                    name=f'{workload["metadata"]["name"]}-{ordinal}', image=container['image'],
                    words=[expand(word, environment) for word in container['args']], address=address,
                    probes={kind: container[kind]['exec']['command'] if 'exec' in container[kind]
                            else container[kind]['httpGet'] for kind in ('readinessProbe', 'livenessProbe')
                            if kind in container},
                    config=mapped[0]['data']['launch.yaml'] if mapped and mapped[0] else '',
                    service=behind[0] if behind else ''))
    return processes
