#!/usr/bin/python3
"""Draws the plots of ecobench and writes report.html, papers.html and summary.json.

    report.py OUT CACHE [PAPERS.json]

CACHE/run.json names the sections of the program in their order, and the one that ran, whose bars are printed; CACHE/sections/NAME.json is the record that each
left (bench.c). PAPERS.json (papers.json beside this file) sets tables and pictures beside the papers' figures:
[{"paper", "title", "entries": [{"figure", "says", "section", "show": [patterns], "why"}]}]. Plots need
python3-matplotlib; without it the pages hold tables and pictures only."""
import fnmatch
import html
import json
import os
import re
import sys
import time

ROWS_OPEN = 32        # longer tables are folded
PICTURES_MOST = 6     # of one pattern, in papers.html
STYLE = """
:root{color-scheme:light dark;--ink:#22261f;--soft:#667;--line:#ddd9cf;--page:#fbfaf6;--good:#19703a;--bad:#a8322a}
@media(prefers-color-scheme:dark){:root{--ink:#e6e4dc;--soft:#9aa;--line:#3a3d38;--page:#181a17;--good:#6cc98a;--bad:#f08a80}}
body{font:16px/1.55 system-ui,sans-serif;margin:0 auto;max-width:62rem;padding:1rem;color:var(--ink);background:var(--page)}
h1{font-size:1.6rem}h2{font-size:1.2rem;margin-top:2.4rem;padding-top:.8rem;border-top:1px solid var(--line)}
h3{font-size:1.02rem;margin:1.6rem 0 .3rem}p{max-width:46rem}small,.soft,figcaption,summary{color:var(--soft)}a{color:inherit}
nav{display:flex;flex-wrap:wrap;gap:.2rem .9rem;font-size:.9rem}.wide{overflow-x:auto}
table{border-collapse:collapse;font-size:.86rem;font-variant-numeric:tabular-nums}
th,td{padding:.22rem .65rem;border-bottom:1px solid var(--line);text-align:left;white-space:nowrap}th{white-space:normal}
.n{text-align:right}.good{color:var(--good)}.bad{color:var(--bad)}.note{border-left:3px solid var(--bad);padding-left:.7rem}
figure{margin:1rem 0}img{max-width:100%;background:#fff}
"""


def text(value):
    return html.escape(str(value or ''))


def read(path):
    try:
        with open(path, encoding='utf-8') as file:
            return json.load(file)
    except (OSError, ValueError):
        return None


def write(path, content):
    with open(path + '.tmp', 'w', encoding='utf-8') as file:
        file.write(content)
    os.replace(path + '.tmp', path)


# ---- Plots ----

def draw(plot, path):
    from matplotlib.figure import Figure
    figure = Figure(figsize=(9.6, 6), layout='constrained')
    axes = figure.add_subplot()
    for series in plot['series']:
        x, y = ([float('nan') if v is None or (plot[f'log_{k}'] and v <= 0) else v for v in series[k]] for k in 'xy')
        axes.plot(x, y, 'o' if series['points'] else 'o-' if len(x) <= 40 else '-', markersize=4, label=series['name'])
    axes.set(title=plot['title'], xlabel=plot['x'], ylabel=plot['y'], xscale='log' if plot['log_x'] else 'linear',
             yscale='log' if plot['log_y'] else 'linear')
    axes.grid(color='#e6e6e0')
    if plot['series']:
        axes.legend(fontsize='small')
    figure.savefig(path, dpi=100, format='png')


def draw_plots(out, cache, records):
    """Only what is newer than its picture."""
    for record in records:
        made = os.path.getmtime(f'{cache}/sections/{record["name"]}.json')
        for plot in (item for item in record['items'] if item['kind'] == 'plot'):
            path = f'{out}/{plot["name"]}.png'
            if os.path.exists(path) and os.path.getmtime(path) >= made:
                continue
            try:
                draw(plot, path)
            except ImportError:
                print('report.py: no plots without python3-matplotlib', file=sys.stderr)
                return


# ---- Items of a record ----

def is_number(cell):
    return re.fullmatch(r'[-+0-9.eE% x]*[0-9][-+0-9.eE% x]*|-?|-?nan', cell) is not None


def cell_of(cell, tag, like=None):
    number = ' class="n"' if is_number(cell if like is None else like) else ''
    return f'<{tag}{number}>' + ('\u2013' if cell in ('nan', '-nan') else text(cell))


def table_of(item):
    file = f'<a href="{text(item["name"])}.csv">{text(item["name"])}.csv</a>'
    if not item['show']:
        return f'<p class="soft">Table: {file}</p>\n'
    rows = [row.split(',') for row in item['rows']]
    names = item['columns'].split(',')
    lines = ''.join(map(cell_of, names, ['th'] * len(names), rows[0] if rows else ['x'] * len(names)))
    lines += ''.join('<tr>' + ''.join(cell_of(cell, 'td') for cell in row) for row in rows)
    table = f'<div class="wide"><table><tr>{lines}</table></div>'
    if len(rows) > ROWS_OPEN:
        table = f'<details><summary>{len(rows)} rows</summary>{table}</details>'
    return f'{table}<p class="soft"><small>As a file: {file}</small></p>\n'


def item_of(item, out):
    kind = item['kind']
    if kind == 'table':
        return table_of(item)
    if kind in ('picture', 'plot'):
        file, caption = (item['file'], item['caption']) if kind == 'picture' else (item['name'] + '.png', item['title'])
        if not os.path.exists(f'{out}/{file}'):
            return f'<p class="note">{text(caption)}: {text(file)} is not there</p>\n'
        return (f'<figure><img loading="lazy" src="{text(file)}" alt="{text(caption)}">'
                f'<figcaption>{text(caption)}</figcaption></figure>\n')
    return '<h3>{}</h3>\n'.format(text(item['text'])) if kind == 'head' else '<p>{}</p>\n'.format(text(item['text']))


# ---- Figures and their bars ----

def reached(bar, value):
    """Whether "<= 0.01", ">= 65 %", "at most 5 %" or "0" holds; None where the words name no bar."""
    match = re.match(r' *(<=|≤|at most|>=|≥|at least|) *([0-9.,]*[0-9])[.,]? *(%?)', bar)
    if not match:
        return None
    if value is None:
        return False
    limit = float(match[2].replace(',', '')) / (100 if match[3] else 1)
    slack = 1e-9 * abs(limit)
    if match[1] in ('<=', '≤', 'at most'):
        return value <= limit + slack
    return value >= limit - slack if match[1] else abs(value - limit) <= slack


def keys_of(records, barred):
    rows = [(key, reached(key['bar'], key['value']), record['name']) for record in records for key in record['keys']]
    rows = [row for row in rows if (row[1] is not None) == barred]
    lines = ''
    for key, met, name in rows:
        value = 'not measured' if key['value'] is None else f'{key["value"]:.0f}' if key['value'] == int(
            key['value']) else f'{key["value"]:.4g}'
        word = '' if met is None else '<b class="good">met</b>' if met else '<b class="bad">not met</b>'
        lines += (f'<tr><td>{text(key["key"])}<td class="n">{value}<td>{text(key["bar"])}<td>{word}'
                  f'<td><a href="#{text(name)}">{text(name)}</a>')
    count = f'<p>{sum(row[1] is True for row in rows)} of {len(rows)} bars are met.</p>\n' if barred else ''
    return (f'<div class="wide"><table><tr><th>figure<th class="n">measured<th>{"bar" if barred else "what it is"}<th>'
            f'<th>section{lines}</table></div>\n{count}')


def print_bars(record):
    for key in record['keys']:
        met = reached(key['bar'], key['value'])
        if met is not None:
            word = 'absent' if key['value'] is None else 'met' if met else 'missed'
            print(f'{word:7}{key["key"]:32}{"-" if key["value"] is None else format(key["value"], ".4g"):9}{key["bar"]}', file=sys.stderr)


def summary_of(run, records):
    keys = [key for record in records for key in record['keys']]
    summary = {key['key']: key['value'] for key in keys}
    summary['bars'] = {key['key']: key['bar'] for key in keys}
    summary['reached'] = {key['key']: reached(key['bar'], key['value']) for key in keys}
    summary['sections'] = {r['name']: {'state': r['state'], 'full': r['full'],
                                       'this_program': r['program'] == run['program']} for r in records}
    summary['about'] = about(run)
    return summary


def about(run):
    try:
        with open('/proc/cpuinfo', encoding='utf-8') as file:
            model = re.search(r'^model name\s*: (.*)', file.read(), re.M)
    except OSError:
        model = None
    return {'when': time.strftime('%Y-%m-%d %H:%M UTC', time.gmtime()), 'processor': model[1] if model else '',
            'cores': os.cpu_count(), 'full': run['full'], 'program': run['program'], 'data': run['data']}


# ---- Pages ----

def page(title, head, links, body):
    nav = ''.join(f'<a href="#{text(to)}">{text(name)}</a>' for to, name in links)
    return (f'<!doctype html><html lang="en"><meta charset="utf-8"><meta name="viewport" content="width=device-width">'
            f'<title>{text(title)}</title><style>{STYLE}</style><h1>{text(title)}</h1>\n<p>{head}</p>\n<nav>{nav}</nav>\n'
            f'{body}</html>\n')


def section_of(record, run, out):
    body = f'<h2 id="{text(record["name"])}">{text(record["title"])}</h2>\n'
    if record['state'] != 'done':
        why = record.get('why', '')
        body += '<p class="note">This section is not complete ({}){}.</p>\n'.format(
            text(record['state']), ': ' + text(why) if why and why != record['state'] else '')
    if record['program'] != run['program']:
        body += '<p class="note">From an earlier build of the program: run it again for figures of this one.</p>\n'
    if not record['full']:
        body += '<p class="soft"><small>Quick run: fewer frames, plants or methods than with FULL=1.</small></p>\n'
    body += ''.join(item_of(item, out) for item in record['items'])
    return body + f'<p class="soft"><small>{record["seconds"]:.0f} s in this run.</small></p>\n'


def report(run, records, out):
    machine = about(run)
    head = ('{} run, {}, {}, {} cores. Vertices are points + 2 · lines + 3 · triangles, instances counted. '
            'P = tp/(tp+fp) and R = tp/(tp+fn) over covered pixels; Q = 1 − √((1−P)² + (1−R)²); skill is what is won over '
            'a plain card that covers every pixel; owner_q counts only pixels that show the right plant.').format(
                'Full' if run['full'] else 'Quick', machine['when'], text(machine['processor']), machine['cores'])
    body = '' if records else '<p>No section has been run yet.</p>\n'
    body += '<h2 id="bars">Figures and bars</h2>\n' + keys_of(records, True)
    body += f'<details><summary>Figures without a bar</summary>{keys_of(records, False)}</details>\n'
    return page('ecobench: error against run time', head,
                [('bars', 'Figures and bars')] + [(r['name'], r['title']) for r in records],
                body + ''.join(section_of(record, run, out) for record in records))


def matches(item, pattern):
    name = item.get('file') or item.get('name') or ''
    return any(fnmatch.fnmatchcase(n, pattern) for n in (name, name.split('.')[0], name.split('.')[0] + '.png'))


def entry_of(entry, records, out):
    """The entry and how many of its names match nothing in a complete full run."""
    section, missing, shown = entry['section'], 0, ''
    record = records.get(section)
    done = record is not None and record['state'] == 'done'
    for pattern in entry['show'] if record else []:
        found = [item for item in record['items'] if matches(item, pattern)]
        missing += done and record['full'] and not found
        shown += ''.join(item_of({**item, 'show': True}, out) for item in found[:PICTURES_MOST])
        if len(found) > PICTURES_MOST:
            shown += (f'<p class="soft"><small>{len(found) - PICTURES_MOST} more in <a href="report.html#{text(section)}">'
                      'the report</a>.</small></p>\n')
    if not shown:
        left_out = done and not record['full']
        shown = '<p class="note">{}: <code>make bench {}ONLY={}</code></p>\n'.format(
            'Left out of quick runs' if left_out else 'Not run yet', 'FULL=1 ' if left_out else '', text(section))
    return (f'<h3>{text(entry["figure"])}</h3>\n<p>{text(entry["says"])}.</p>\n{shown}<p><strong>Why they differ.</strong> '
            f'{text(entry["why"])} <a class="soft" href="report.html#{text(section)}">More</a></p>\n'), missing


def papers_page(papers, records, out):
    missing, body = 0, ''
    records = {record['name']: record for record in records}
    for number, paper in enumerate(papers):
        body += f'<h2 id="paper{number}">{text(paper["paper"])}</h2>\n<p class="soft">{text(paper["title"])}</p>\n'
        for entry in paper['entries']:
            shown, absent = entry_of(entry, records, out)
            body += shown
            missing += absent
    if missing:
        print(f'report.py: {missing} names of papers.json are in no section that is done', file=sys.stderr)
    return page('The papers beside ecostream', 'Each table and figure with ours, and why they differ. The '
                '<a href="report.html">report</a> says how it was measured.',
                [(f'paper{number}', paper['paper']) for number, paper in enumerate(papers)], body)


def main():
    out, cache = sys.argv[1:3]
    papers = sys.argv[3] if len(sys.argv) > 3 else os.path.join(os.path.dirname(os.path.abspath(__file__)), 'papers.json')
    run = read(f'{cache}/run.json')
    records = [read(f'{cache}/sections/{name}.json') for name in run['sections']]
    records = [record for record in records if record and isinstance(record.get('items'), list)]
    for record in records:
        if record['name'] == run.get('ran'):
            print_bars(record)
    draw_plots(out, cache, records)
    write(f'{out}/report.html', report(run, records, out))
    write(f'{out}/papers.html', papers_page(read(papers), records, out))
    write(f'{out}/summary.json', json.dumps(summary_of(run, records), indent=2, ensure_ascii=False))


main()
