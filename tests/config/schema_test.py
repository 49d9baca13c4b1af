#!/usr/bin/env python3
"""The JSON schemas of docs/ against a validator that is not ours: they take every shipped file, and refuse what the
reader refuses.   schema_test.py SOURCE_DIR PROGRAM"""

import json
import pathlib
import re
import subprocess
import sys
import tempfile

import jsonschema
import yaml


class Loader(yaml.SafeLoader):
    """Numbers as in YAML 1.2, which is what editors and our reader take: 5e-3 is one."""


Loader.add_implicit_resolver('tag:yaml.org,2002:float', re.compile(r'^[-+]?[0-9]+(\.[0-9]*)?([eE][-+]?[0-9]+)?$'),
                             list('-+0123456789'))

SCENE = 'shapes: {ball: {sphere: {radius: 0.5}}}\nprototypes: {ball: {shape: ball, mass: 1}}\n'
LAUNCH = 'scene: scene.yaml\nregions: {layout: columns, count: 2, width: 40}\n'

GOOD_LAUNCHES = [
    LAUNCH,
    'scene: scene.yaml\nregions: {count: 1}\n',
    'scene: scene.yaml\nregions: {layout: brick, rows: 2, columns: 2, cell: [40, 40], neighbour_distance: 50}\n',
    'scene: scene.yaml\nregions: {layout: grid, count: 4, cell: [40, 40]}\n',
    'scene: scene.yaml\nregions: {layout: grid, count: 1}\n',
    'scene: scene.yaml\nregions: {layout: boxes, boxes: [[0, 0, 40, 40], [40, 0, 80, 40]]}\n',
    'scene: scene.yaml\nregions: {layout: boxes, count: 1}\n',
    LAUNCH + 'time: {lookahead: auto}\n',
    LAUNCH + 'time: {lookahead: 3, sync: deterministic}\n',
    LAUNCH + 'dds: {impair: {jitter: 5e-3, loss: 0}}\n',
]
BAD_LAUNCHES = [
    'regions: {count: 1}\n',
    LAUNCH + 'speed: 3\n',
    'scene: scene.yaml\nregions: 4\n',
    'scene: scene.yaml\nregions: {layout: columns, count: 2}\n',
    'scene: scene.yaml\nregions: {layout: columns, count: -3, width: 40}\n',
    'scene: scene.yaml\nregions: {layout: columns, count: 2.5, width: 40}\n',
    'scene: scene.yaml\nregions: {layout: columns, count: 2, width: 0}\n',
    'scene: scene.yaml\nregions: {layout: columns, count: 2, width: 40, rows: 2}\n',
    'scene: scene.yaml\nregions: {layout: hexagons, count: 2}\n',
    'scene: scene.yaml\nregions: {layout: grid, rows: 2, columns: 2}\n',
    'scene: scene.yaml\nregions: {layout: grid, rows: 2, columns: 2, cell: [40]}\n',
    'scene: scene.yaml\nregions: {layout: boxes, boxes: []}\n',
    LAUNCH + 'time: {step_hz: 0}\n',
    LAUNCH + 'time: {lookahead: far}\n',
    LAUNCH + 'time: {sync: sometimes}\n',
    LAUNCH + 'tolerances: {speed: 0}\n',
    LAUNCH + 'physics: {continuous: maybe}\n',
    LAUNCH + 'physics: {preset: best}\n',
    LAUNCH + 'dds: {interfaces: []}\n',
    LAUNCH + 'dds: {impair: {dealy: 0.1}}\n',
    LAUNCH + 'dds: {impair: {loss: 1.5}}\n',
]
GOOD_SCENES = [
    SCENE,
    SCENE + 'bodies: [{prototype: ball, name: 5, orientation: {quaternion: [1, 0, 0, 0]}}]\n',
    SCENE + 'statics: [{shape: {compound: {parts: [{sphere: {radius: 1}, position: [0, 0, 1]}]}}}]\n',
    SCENE + 'statics: [{shape: {heightfield: {cell: [1, 1], heights: [[0, 0], [0, 1]]}}}]\n',
    SCENE + 'bodies: [{prototype: ball, name: a}]\njoints: [{spring: {x: {}, rz: {limits_deg: [0, 9]}}, bodies: [a]}]\n',
    SCENE + 'layout: launch\ninjectors: [{rate: 1, count: 5, prototypes: [ball], '
            'per: {regions: {size: [1, 1, 1], height: 3}}}]\n',
]
BAD_SCENES = [
    SCENE + 'bodys: []\n',
    'gravity: [0, -9.81]\n',
    'gravity: [0, 0, down]\n',
    'materials: {ice: {friction: -1}}\n',
    'shapes: {it: {teapot: {radius: 1}}}\n',
    'shapes: {it: {sphere: {radius: 1}, box: {size: [1, 1, 1]}}}\n',
    'shapes: {it: {}}\n',
    'shapes: {it: {sphere: }}\n',
    'shapes: {it: {box: {size: [1, 0, 1]}}}\n',
    'shapes: {it: {capsule: {radius: 1, height: 1, total_height: 3}}}\n',
    'shapes: {it: {convex_hull: {points: [[0, 0, 0], [1, 0, 0], [0, 1, 0]]}}}\n',
    'shapes: {it: {convex_hull: {points: [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], scale: 2}}}\n',
    'shapes: {it: {compound: {parts: [{plane: {}}]}}}\n',
    'prototypes: {it: {shape: {sphere: {radius: 1}}}}\n',
    SCENE + 'bodies: {ball: 1}\n',
    SCENE + 'bodies: [{prototype: ball, orientation: {quaternion: [1, 0, 0, 0], rpy_deg: [0, 0, 0]}}]\n',
    SCENE + 'generators: [{spiral: {prototype: ball}}]\n',
    SCENE + 'generators: [{stack: {count: 3}}]\n',
    SCENE + 'generators: [{stack: {prototype: ball, count: 3, gap: 1}}]\n',
    SCENE + 'injectors: [{rate: 1, count: 5, prototypes: [ball]}]\n',
    SCENE + 'joints: [{ball: {axis: [0, 0, 1]}, bodies: [a]}]\n',
    'layout: round\n',
]


class Schemas:
    def __init__(self, source, program):
        self.source = pathlib.Path(source)
        self.program = program
        self.failures = 0
        self.of = {kind: self.load(kind) for kind in ('launch', 'scene')}

    def load(self, kind):
        schema = json.loads((self.source / f'docs/aurasim-{kind}.schema.json').read_text())
        jsonschema.Draft7Validator.check_schema(schema)
        return jsonschema.Draft7Validator(schema)

    def errors(self, kind, text):
        return [f'{"/".join(map(str, e.path))}: {e.message}' for e in self.of[kind].iter_errors(yaml.load(text, Loader))]

    def expect(self, what, condition, text, why=''):
        if condition:
            return
        self.failures += 1
        print(f'FAILED: {what}:\n{text}{why}\n')

    def reader_takes(self, launch, scene):
        with tempfile.TemporaryDirectory() as folder:
            (pathlib.Path(folder) / 'launch.yaml').write_text(launch)
            (pathlib.Path(folder) / 'scene.yaml').write_text(scene)
            run = subprocess.run([self.program, 'check', folder + '/launch.yaml'], capture_output=True, check=False)
            return run.returncode == 0

    def check_shipped(self):
        folder = self.source / 'launch_configs'
        shipped = [('launch', file) for file in folder.glob('*.yaml')] + \
                  [('scene', file) for file in (folder / 'scenes').glob('*.yaml')]
        self.expect('there are shipped files', len(shipped) >= 28, '')
        for kind, file in shipped:
            errors = self.errors(kind, file.read_text())
            self.expect(f'the schema takes {file}', not errors, '', '\n'.join(errors))

    def check_cases(self, kind, texts, good):
        for text in texts:
            errors = self.errors(kind, text)
            self.expect(f'the schema {"takes" if good else "refuses"}', good == (not errors), text, '\n'.join(errors))
            taken = self.reader_takes(*((text, SCENE) if kind == 'launch' else (LAUNCH, text)))
            self.expect(f'the reader {"takes" if good else "refuses"}', good == taken, text)


def main():
    schemas = Schemas(sys.argv[1], sys.argv[2])
    schemas.check_shipped()
    schemas.check_cases('launch', GOOD_LAUNCHES, True)
    schemas.check_cases('launch', BAD_LAUNCHES, False)
    schemas.check_cases('scene', GOOD_SCENES, True)
    schemas.check_cases('scene', BAD_SCENES, False)
    print(f'{schemas.failures} failures')
    sys.exit(1 if schemas.failures else 0)


main()
