#!/bin/sh
# papers.html: report.py shows tables and pictures beside those of papers.json; papers.json names sections, tables and pictures that exist.
command -v python3 >/dev/null || exit 77
exec python3 - "$(mktemp -d)" <<'PY'
import glob, json, os, re, shutil, subprocess, sys

folder = sys.argv[1]
PAPER = {'paper': 'Lee <2007>', 'title': 'Trees'}
ENTRY = {'figure': 'Table I', 'says': 'Wrong pixels', 'section': 'lee', 'why': 'Other trees'}
ITEMS = [{'kind': 'table', 'name': 'wrong', 'columns': 'a,b', 'rows': ['1,2'], 'show': False},
         {'kind': 'table', 'name': 'other', 'columns': 'c', 'rows': ['3'], 'show': True},
         {'kind': 'picture', 'file': 'tree-1.png', 'caption': 'one'}, {'kind': 'picture', 'file': 'tree-2.png', 'caption': 'two'}]
RECORD = {'name': 'lee', 'title': 'Lee', 'program': '1', 'seconds': 1, 'keys': [], 'items': ITEMS}
# what an entry names, state and kind of its record, strings that the page has and has not, whether names are told to match nothing
PAGES = [
    # a table is shown even where the report names its file only
    (['wrong', 'tree-2'], ('done', True), ['Lee &lt;2007&gt;', '<h3>Table I</h3>', 'Wrong pixels.', 'Other trees',
     '<td class="n">1<td class="n">2', 'tree-2.png'], ['other.csv', 'tree-1.png'], False),
    (['tree-*.png'], ('done', True), ['tree-1.png', 'tree-2.png'], ['wrong.csv'], False),
    (['wrong'], None, ['Not run yet: <code>make bench ONLY=lee', 'Other trees'], ['wrong.csv'], False),
    (['gone'], ('done', False), ['Left out of quick runs: <code>make bench FULL=1 ONLY=lee'], [], False),
    (['gone'], ('failed', False), ['Not run yet: <code>make bench ONLY=lee'], [], False),
    (['wrong', 'gone'], ('done', True), ['wrong.csv'], [], True),
    (['gone'], ('missing', True), ['Not run yet'], [], False)]


def write(name, value):
    with open(f'{folder}/{name}', 'w', encoding='utf-8') as file:
        file.write(value if isinstance(value, str) else json.dumps(value))


def check_page(show, state, says, hides, missing):
    write('papers.json', [{**PAPER, 'entries': [{**ENTRY, 'show': show}]}])
    write('sections/lee.json', {**RECORD, 'state': state[0], 'full': state[1]} if state else '')
    told = subprocess.run([os.path.abspath('tests/bench/report/report.py'), '.', '.', 'papers.json'], cwd=folder, check=True,
                          stderr=subprocess.PIPE, text=True).stderr
    with open(f'{folder}/papers.html', encoding='utf-8') as file:
        page = file.read()
    assert all(word in page for word in says), (show, state, says)
    assert not any(word in page for word in hides), (show, state, hides)
    assert ('papers.json' in told) == missing, told


# A string that is it; of a pattern, one that begins as it does; or the format that makes it of a scene's name.
def is_made(sources, name):
    begins = re.split('[-*?]' if re.search('[*?]', name) else '[.]', name)[0]
    return f'"{begins}' + ('"' if begins == name else '') in sources or f'"{name.split("_")[0]}_%s"' in sources


def check_names():
    sources = ''.join(open(path, encoding='utf-8').read() for path in glob.glob('tests/bench/**/*.c', recursive=True))
    with open('tests/bench/report/papers.json', encoding='utf-8') as file:
        entries = [entry for paper in json.load(file) for entry in paper['entries']]
    assert len(entries) > 15
    for entry in entries:
        assert all(entry[key] for key in ('figure', 'says', 'section', 'show', 'why')), entry
        assert f'const struct bench_section bench_{entry["section"]} =' in sources, entry['section']
        for name in entry['show']:
            assert is_made(sources, name), f'no source of ecobench makes {name}'


os.mkdir(f'{folder}/sections')
write('run.json', {'full': True, 'program': '1', 'data': None, 'sections': ['lee']})
write('tree-1.png', '')
write('tree-2.png', '')
for page in PAGES:
    check_page(*page)
check_names()
shutil.rmtree(folder)
PY
