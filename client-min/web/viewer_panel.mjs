// The viewer's words on the picture: figures, a legend, scale and north, which plant was clicked, and why
// the picture is what it is.

import { fixed, t } from './viewer_text.mjs';

const $ = (id) => document.getElementById(id);

export function number(n) {
	if (n >= 1e6)
		return `${fixed(n / 1e6, 2)} M`;
	return n >= 1e4 ? `${fixed(n / 1e3, 0)} k` : `${Math.round(n)}`;
}

export const metres = (length) => length < 10000 ? `${fixed(length, length < 10 ? 2 : 1)} m`
	: `${fixed(length / 1000, 1)} km`;

const span = (text) => Object.assign(document.createElement('span'), { textContent: text });

function item(...cells) {
	const li = document.createElement('li');
	li.append(...cells);
	return li;
}

/** A table's row of cells, of texts or elements, and what it is of. */
function row(texts) {
	const tr = document.createElement('tr');
	tr.dataset.of = texts.of ?? '';
	for (const text of texts)
		tr.insertCell().append(text);
	return tr;
}

function swatch(color) {
	const box = Object.assign(document.createElement('span'), { className: 'swatch' });
	box.style.backgroundColor = Array.isArray(color) ? `rgb(${color.join(' ')})` : color;
	return box;
}

// ---- Species ----

const NAMED_MOST = 3;            // of several species, in a line
let known = [];                  // by the number of a plant of the pack: openapi.yaml's Species

const UNSTATED = t('species not stated');

/** The server's description of the plants' species, or null. */
export function nameSpecies(species) {
	known = species ?? [];
}

const isObject = (plant) => Boolean(known[plant]?.object);
export const hasObjects = () => known.some(({ object }) => object);

/** The species that a plant of the pack stands for: "oak, ash and 3 more", and all of them. */
function speciesOf({ number: index, name }) {
	const own = { plant: name, species_count: 1, species: [{ species: name }] };
	const { species_count: all, species } = known[index]?.plant === name ? known[index] : own;
	const names = species.map(({ species: one }) => one ?? UNSTATED), [only] = names;
	if (all === 1)
		return { short: only, long: isSame(only, name) ? only : t('{}, shown as {}', only, name) };
	const more = (count) => count ? t(' and {} more', number(count)) : '';
	const most = Math.min(all, NAMED_MOST) - 1;
	const counted = species.map(({ species: one, plants }) => `${one ?? UNSTATED} (${plants})`);
	const last = all > NAMED_MOST ? more(all - most) : t(' and {}', names[most]);
	return { short: `${names.slice(0, most).join(', ')}${last}`,
		long: t('Shown as {}: {}', name, counted.join(', ')) + more(all - species.length) };
}

/** Whether a plant's species is what it is shown as. */
const isSame = (species, plant) => species?.toLowerCase() === plant.toLowerCase();

const opened = new Set();        // names whose other text is shown

/** A name in short, which a tap or a key opens to what it is in full. */
function named({ short, long }) {
	if (short === long)
		return span(short);
	const box = document.createElement('details'), head = document.createElement('summary');
	head.textContent = short;
	box.append(head, long);
	box.open = opened.has(long);
	box.ontoggle = () => opened[box.open ? 'add' : 'delete'](long);
	return box;
}

// ---- Tints ----

let drawn = [];          // classes on the ground

/** The legend, on the picture: classes of a column and how many plants have each, and classes that are drawn on the ground. */
export function showLegend({ tints = [], drawn: ground = [] }) {
	drawn = ground;
	const all = [...tints, ...ground.length ? [{ column: t('Ground'), classes: ground }] : []];
	const lists = all.map(({ classes }) => {
		const ul = document.createElement('ul');
		ul.append(...classes.map(({ name, color, plants, features }) =>
			item(color ? swatch(color) : span(t('own')), span(t(name)), span(number(plants ?? features)))));
		return ul;
	});
	const legend = $('legend'), [head] = legend.children;
	head.textContent = all.map(({ column }) => column).join(', ');
	legend.replaceChildren(head, ...lists);
	legend.hidden = !lists.length;
}

// ---- The picture ----

/** Plants of the pack, those that are called alike as one, of their mean height. */
function bySpecies(models) {
	const all = new Map();
	for (const model of models) {
		const { short, long } = speciesOf(model), { count, height_m: height } = model, one = all.get(short);
		const sum = (one?.count ?? 0) + count;
		all.set(short, { short, long: one ? `${one.long}; ${long}` : long, count: sum, number: model.number,
			height_m: ((one?.height_m ?? 0) * (sum - count) + height * count) / sum });
	}
	return [...all.values()];
}

export function showFacts(facts) {
	const tiles = facts.roles.some(({ name, vertices }) => name === 'summaries' && vertices);
	const figures = [
		[t('Vertices'), number(facts.vertices)],
		[t('Plants in view'), tiles ? t('{}, more as points', number(facts.plants)) : number(facts.plants)],
		[t('Predicted Q'), facts.predicted_q ? fixed(facts.predicted_q, 3) : '–'],
		[t('Predicted m16'), facts.predicted_q ? fixed(facts.predicted_m16, 2) : '–'],
		[t('Bytes so far'), number(facts.bytes)],
		[t('Decoded'), `${fixed(facts.memory_bytes / 2 ** 20, 1)} MiB`],
	];
	$('figures').replaceChildren(...figures.map(row));
	$('roles').replaceChildren(...facts.roles.filter((role) => role.vertices).map((role) =>
		item(swatch(role.color), span(t(role.name)), span(number(role.vertices)))));
	// objects come after the plants
	const last = ({ number: of }) => isObject(of) ? 1 : 0;
	const species = bySpecies(facts.models).sort((a, b) => last(a) - last(b) || b.count - a.count).map((plant) =>
		item(named(plant), span(metres(plant.height_m)), span(`× ${number(plant.count)}`)));
	const none = t(tiles ? 'Only points that stand for many plants' : 'None');
	$('species').replaceChildren(...species.length ? species : [item(none)]);
}

/** The measured error of a picture, for its caption: { picture_error, m16, vertices, full }. */
export const errorText = ({ picture_error: error, m16, vertices, full }) =>
	t(full ? '; measured error beside full detail ({} vertices): FLIP {}, m16 {}' : '; measured error beside {} vertices: FLIP {}, m16 {}',
		number(vertices), fixed(error, 3), fixed(m16, 2));

/** The same, with what it means. */
export function showError(error) {
	$('error').hidden = false;
	$('error').firstElementChild.textContent = errorText(error).slice(2);
}

function lengthText(length) {
	if (length >= 1000)
		return `${length / 1000} km`;
	if (length >= 1)
		return `${length} m`;
	return length >= 0.01 ? `${Math.round(length * 100)} cm`
		: `${Number((length * 1000).toPrecision(1))} mm`;
}

/** A length at the distance of what is looked at, and where north is; `pixel` metres a pixel there. */
export function showScale(pixel, heading) {
	const most = pixel * 120, unit = 10 ** Math.floor(Math.log10(most));
	const length = unit * [5, 2, 1].find((n) => n * unit <= most);
	$('scale-bar').style.width = `${length / pixel}px`;
	$('scale-text').textContent = lengthText(length);
	$('north').style.transform = `rotate(${-heading * 180 / Math.PI}deg)`;
}

/** Up on the map is north where the scene has a CRS, else only its y. */
export function showNorth(known) {
	$('north').lastElementChild.textContent = known ? 'N' : 'Y';
	$('north').setAttribute('aria-label', t(known ? 'North' : 'The y axis of the scene'));
}

// ---- What was clicked ----

/** A place for people: in the scene's coordinates if it has some, which find it in an inventory. */
export function placeText([x, y, z], origin) {
	const text = (value, i) => fixed(value + (origin?.at[i] ?? 0), 2);
	return `${text(x, 0)}, ${text(y, 1)}, ${text(z, 2)}${origin?.crs ? ` (${origin.crs})` : ' m'}`;
}

/** A plant's primitives by representation. Those that a list has beside them may be another form of the
 * same, so that they say nothing of what is lacking. */
function drawnBy(cuts) {
	const sums = new Map();
	for (const { role, first, end } of cuts)
		sums.set(role, (sums.get(role) ?? 0) + end - first);
	return [...sums].map(([role, drawn]) => [t(role), number(drawn)]);
}

const titles = { plant: 'A plant', object: 'A building or other object', sky: 'The sky', ground: 'The ground',
	summary: 'Many plants as one point' };

/** `picked`: what is seen there (web_client.h). */
const COLOR_NEAR = 24;          // of a channel, in bytes: colours of texels are rounded
/** The class on the ground whose colour is nearest to that of a place; undefined: none is near. */
function groundClass(rgb) {
	const apart = ({ color }) => Math.max(...rgb.map((v, i) => Math.abs(v - parseInt(color.slice(1 + 2 * i, 3 + 2 * i), 16))));
	return [...drawn].filter((c) => apart(c) <= COLOR_NEAR).sort((a, b) => apart(a) - apart(b))[0];
}

export function showPicked(picked, origin) {
	const { kind, plant, number: index, at, foot, cuts = [] } = picked;
	const { height_m: height, crown_m: crown, distance_m: distance, tint, tints = [] } = picked;
	const facts = [], species = plant && speciesOf({ number: index, name: plant }), object = isObject(index);
	if (height)
		facts.push(Object.assign([t('Height'), metres(height)], { of: 'height' }));
	if (crown)
		facts.push(Object.assign([t(object ? 'Width' : 'Crown width'), metres(crown)], { of: 'crown' }));
	// the first of a colour, as ecoserve says; black stands for a plant's own
	const classes = tints.flatMap(({ column, classes: all }) => all.map((one) => ({ column, ...one })));
	const own = tint && classes.find(({ color }) => (color ?? '#000000') === tint);
	if (own)
		facts.push([t('Class'), `${t(own.name)} (${own.column})`]);
	if (kind === 'summary' && plant)
		facts.push([t('Of these'), named(species)]);
	const ground = picked.rgb && groundClass(picked.rgb);
	if (ground)
		facts.push([t('Ground'), t(ground.name)]);
	if (at ?? foot)
		facts.push([t(foot ? 'Stands at' : 'Place'), placeText(foot ?? at, origin)],
			[t('Distance'), metres(distance)]);
	$('card-title').textContent = t(titles[object ? 'object' : kind]);
	$('card-facts').replaceChildren(...facts.map(row));
	$('card-why').replaceChildren();
	$('card-drawn').hidden = !cuts.length;
	$('card-forms').replaceChildren(...drawnBy(cuts).map(row));
	$('card-orbit').hidden = !(at ?? foot);
	$('card').hidden = false;
}

/** The plant by the inventory that it comes from, if it comes from one. The picture alone knows only what
 * it is shown as, which may stand for several species; and so does a published scene, where `species` is not given.
 * `columns` name the cells; two say what sizes are guessed from. */
export function showPlant({ species, plant, file, row: number, line, cells = [] }, model, columns = []) {
	const title = species === undefined ? speciesOf({ number: model, name: plant }).short : species ?? t('Species not stated');
	$('card-title').textContent = title;
	const facts = isSame(title, plant) ? [] : [[t('Shown as'), plant]];
	if (file)
		facts.push([t('Row'), t('{} of {}', number, file) + (line ? t(' (line {})', line) : '')]);
	columns.forEach((column, i) => {
		const [size] = /^(height|crown)(?=_from$)/.exec(column) ?? [];
		if (cells[i] && !size)
			facts.push([column, cells[i]]);
		else if (cells[i])
			$('card-facts').querySelector(`[data-of=${size}]`)?.lastChild.append(Object.assign(
				span(t(`guessed from ${cells[i]}`)), { className: 'guess' }));
	});
	($('card-facts').querySelector('[data-of=crown]') ?? $('card-facts').rows[0]).after(...facts.map(row));
}

/** Why a plant is drawn as it is: of each kind of reason the one for most vertices, the most important ones. */
export function showReasons(reasons) {
	const kinds = new Map();
	for (const { why, reason, vertices } of reasons.filter((row) => row.reason)) {
		const { sum = 0, most = -1, text } = kinds.get(why) ?? {};
		kinds.set(why, { sum: sum + vertices, most: Math.max(most, vertices),
			text: vertices > most ? reason : text });
	}
	const texts = [...kinds.values()].sort((a, b) => b.sum - a.sum).slice(0, REASONS_MAX);
	const parts = texts.length > 1 ? ['Why: mostly, {}', 'Why: in part, {}'] : ['Why: {}'];
	$('card-why').replaceChildren(...texts.map(({ text }, i) => item(span(t(parts[i], text)))));
}

// ---- Why the picture is what it is ----

const REASONS_MAX = 2;
/** Kinds of reasons (openapi.yaml's `why`), for those whose vertices are counted. */
const meanings = {
	all: 'plants in full detail',
	'next step': 'detail; more would hardly be seen',
	'no room': 'detail that ends where the vertices do',
	bytes: 'detail that ends where the bytes do',
	'within a step': 'more detail in some of many like plants',
	'left over': 'a little more detail than needed, as some was left over',
	'whole plant': 'plants drawn as a whole, as single leaves would not be seen',
	summary: 'points that stand for many plants',
	far: 'points that stand for many plants, far away',
	'gives way': 'points that stand for many plants, between single ones',
	'sample distance': 'what the rule of Deussen asks for',
};

const percent = (share) => share < 0.01 ? '< 1 %' : `${Math.round(100 * share)} %`;

/** The uses of the vertices, most first. */
function spentOn(spent) {
	const all = Object.values(spent).reduce((a, b) => a + b, 0);
	return Object.entries(spent).filter(([, vertices]) => vertices).sort(([, a], [, b]) => b - a)
		.map(([why, vertices]) => item(span(t(meanings[why] ?? why)), span(percent(vertices / all))));
}

/** Whom a reason is about, and its figures for those who want them. */
function whyText({ plant, tile, distance_m: distance, plants, vertices, reason }) {
	const who = plant ? t('{}, {} away, plants: {}', plant, metres(distance), number(plants))
		: tile === undefined ? t('The ground') : t('Plants of a part of the scene: {}', number(plants));
	return [who, reason, vertices ? t('{} vertices', number(vertices)) : ''];
}

export function showWhy({ lambda, spent, rows, more }) {
	const items = rows.map((line) => {
		const li = item(...whyText(line).filter((text) => text).map(span));
		li.className = 'why';
		return li;
	});
	const least = lambda > 0
		? t('Each vertex puts {} pixels right, or more; none is drawn for less.', lambda.toPrecision(2))
		: t('There is room for all detail of this view.');
	$('spent').replaceChildren(...spentOn(spent));
	$('why').replaceChildren(item(span(least)), ...items, ...more ? [item(span(t('and {} more', more)))] : []);
	$('why-here').hidden = false;
}
