// A link to a view: the part of the page's address after #, as NAME=VALUE&NAME=VALUE. Names that are not known
// are ignored, as others append theirs to links; a value that cannot be read is reported.
import { t } from './viewer_text.mjs';

const VERTICES_MAX = 2 ** 24, SAID_MAX = 40;
const TIME = /^(\d{4}-\d\d-\d\dT\d\d:\d\d)(:\d\d(?:\.\d+)?)?(Z|[+-]\d\d:?\d\d)?$/;

const text = (value) => value;
const choice = (...choices) => (value) => choices.includes(value) ? value : undefined;

function whole(least, most) {
	return (value) => {
		const number = value.trim() === '' ? NaN : Number(value);
		return Number.isInteger(number) && number >= least && number <= most ? number : undefined;
	};
}

/** Some of these words, each once; '' is none. */
function some(...words) {
	return (value) => {
		const given = value.split(',').filter((word) => word);
		return given.every((word) => words.includes(word)) ? [...new Set(given)] : undefined;
	};
}

function point(value) {
	const parts = value.split(',').map((part) => part.trim() === '' ? NaN : Number(part));
	return parts.length === 3 && parts.every(Number.isFinite) ? parts : undefined;
}

/** A time as ecoview's --sun has it, with parts of seconds or without a zone, too: that is UTC. '' is no time. */
function time(value) {
	// + is a space in a query
	const [, minute, second = '', zone = 'Z'] = TIME.exec(value.replace(' ', '+')) ?? [];
	const ms = Date.parse(`${minute}${second}${zone.replace(/(\d\d)(\d\d)$/, '$1:$2')}`);
	return value === '' ? '' : Number.isNaN(ms) ? undefined : new Date(ms).toISOString().slice(0, second ? 19 : 16);
}

/** A list of views, each with a name; '' is none. */
function views(value) {
	const all = value.split(';').filter((one) => one).map((one) => one.split('~')).map(([name, eye = '', target = '']) =>
		({ name, eye: point(eye), target: point(target) }));
	return all.every(({ eye, target }) => eye && target) ? all : undefined;
}

const A_POINT = 'X,Y,Z in metres';
/** Functions that read a value, or find it undefined, and a phrase for the value expected. */
const readers = {
	scene: [text],
	token: [text],
	mode: [choice('orbit', 'walk', 'fly'), 'orbit, walk or fly'],
	vertices: [whole(0, VERTICES_MAX), 'a whole number up to 16777216, 0 for as many as the device draws'],
	bytes: [whole(-1, Number.MAX_SAFE_INTEGER), 'a whole number, -1 for no limit'],
	kind: [whole(0, 1), '0 or 1'],
	smooth: [whole(0, 1), '0 or 1'],
	sun: [time, 'a time such as 2026-06-21T10:00Z'],
	shadows: [choice('none', 'standard', 'perspective'), 'none, standard or perspective'],
	hide: [some('plants', 'objects', 'ground'), 'some of plants, objects, ground'],
	beside: [text],
	wipe: [(value) => Number(value) >= 0 && Number(value) <= 1 ? Number(value) : undefined, 'a number from 0 to 1'],
	views: [views, 'NAME~X,Y,Z~X,Y,Z;... with eye and target'],
	eye: [point, A_POINT],
	target: [point, A_POINT],
};

/** { values, faults }: what a link says, by name, and a sentence for each value that cannot be read. */
export function readLink(hash) {
	const given = new URLSearchParams(hash.replace(/^#/, '')), values = {}, faults = [];
	for (const [name, [read, expected]] of Object.entries(readers)) {
		const value = given.has(name) ? read(given.get(name)) : null;
		if (value === undefined)
			faults.push(t("The link's {}={} cannot be read: {} is expected.", name, given.get(name).slice(0, SAID_MAX),
				t(expected)));
		else if (value !== null)
			values[name] = value;
	}
	const { eye, target } = values;
	if (given.has('eye') !== given.has('target'))
		faults.push(t('The link has one of eye and target: both are needed.'));
	else if (eye && target && eye.every((v, i) => v === target[i]))
		faults.push(t("The link's eye and target are one place."));
	else if (eye && target)
		values.view = [eye, target];
	return { values, faults };
}

/** The link of settings, which have the names above, and a view. */
export function writeLink({ scene, sun, beside, wipe, views: kept, ...settings }, { eye, target }) {
	const place = (v) => v.map((n) => Number(n.toFixed(3))).join(',');
	const views = kept.map((view) => [encodeURIComponent(view.name), place(view.eye), place(view.target)].join('~'));
	const parts = { scene: encodeURIComponent(scene), ...settings, ...beside && { beside: encodeURIComponent(beside), wipe }, sun: sun && `${sun}Z`, views: views.join(';'),
		eye: place(eye), target: place(target) };
	return `#${Object.entries(parts).map(([key, value]) => `${key}=${value}`).join('&')}`;
}
