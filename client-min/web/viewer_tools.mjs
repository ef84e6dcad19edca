// Tools of the viewer: measuring, a tour of saved views, and pictures with a caption.
import { metres } from './viewer_panel.mjs';
import { t } from './viewer_text.mjs';

const $ = (id) => document.getElementById(id);
const SVG = 'http://www.w3.org/2000/svg';

// ---- Measuring ----

const apart = (a, b) => Math.hypot(...a.map((v, i) => v - b[i]));

/** The length between two places, level and upright. */
function lengthText([a, b]) {
	const level = metres(apart(a.slice(0, 2), b.slice(0, 2))), high = metres(Math.abs(b[2] - a[2]));
	return t('{} apart; {} level, {} high', metres(apart(a, b)), level, high);
}

/** Ends of what is measured, or null while nothing is. */
export function sayMeasured(ends) {
	const texts = ['Click where to measure from', 'Click where to measure to'];
	$('measure').setAttribute('aria-pressed', !!ends);
	$('measured').hidden = !ends;
	$('measured').textContent = !ends ? '' : texts[ends.length] ? t(texts[ends.length]) : lengthText(ends);
}

/** Shows them on the picture by its matrix; those behind the eye are left out. */
export function showMeasured(ends, m) {
	const { clientWidth: width, clientHeight: height } = $('picture');
	const at = (ends ?? []).map(([x, y, z]) => [0, 1, 3].map((i) => m[i] * x + m[4 + i] * y + m[8 + i] * z + m[12 + i]))
		.filter(([, , w]) => w > 0).map(([x, y, w]) => [(1 + x / w) * width / 2, (1 - y / w) * height / 2]);
	const shape = (name, values) => {
		const element = document.createElementNS(SVG, name);
		for (const [key, value] of Object.entries(values))
			element.setAttribute(key, value);
		return element;
	};
	$('marks').replaceChildren(shape('polyline', { points: at.join(' ') }),
		...at.map(([cx, cy]) => shape('circle', { cx, cy, r: 5 })));
}

// ---- Views ----

export const LEG_S = 6;                  // from a view of a tour to the next
const REST = 0.3;                        // share of it that the camera stays

/** The eye and target of a tour after some seconds; null: it is over. `jumps`: it goes from view to view at once. */
export function tourAt(views, seconds, jumps) {
	const leg = Math.floor(seconds / LEG_S), from = views[leg], to = views[leg + 1] ?? from;
	if (!from)
		return null;
	const way = Math.max(0, (seconds / LEG_S - leg - REST) / (1 - REST)), share = jumps ? 0 : way * way * (3 - 2 * way);
	const between = (key) => from[key].map((v, i) => v + share * (to[key][i] - v));
	return { eye: between('eye'), target: between('target') };
}

/** A camera script of it, which ecoview replays. */
export const scriptOf = (views, camera) => JSON.stringify({ fps: 2,
	keyframes: views.map(({ eye, target }, i) => ({ ...camera, time_s: i * LEG_S, eye, target })) }, null, 1);

/** Buttons for a list of things: `shown` names one, `chosen` takes it. */
export function showChoices(list, things, shown, chosen, dropped) {
	list.replaceChildren(...things.map((thing) => {
		const li = document.createElement('li'), choose = document.createElement('button');
		choose.textContent = shown(thing);
		choose.onclick = () => chosen(thing);
		li.append(choose);
		if (dropped) {
			const drop = document.createElement('button');
			drop.textContent = '×';
			drop.onclick = () => dropped(thing);
			drop.setAttribute('aria-label', t('Remove {}', shown(thing)));
			li.append(drop);
		}
		return li;
	}));
}

// ---- Pictures ----

/** A picture, a blob, with lines of text below it. */
export async function captioned(picture, lines) {
	const image = await createImageBitmap(picture), { width, height } = image;
	const size = Math.max(10, Math.round(width / 80)), line = size * 1.5, band = Math.ceil(line * (lines.length + 0.6));
	const canvas = Object.assign(document.createElement('canvas'), { width, height: height + band });
	const paper = canvas.getContext('2d');
	paper.fillStyle = '#fff';
	paper.fillRect(0, 0, canvas.width, canvas.height);
	paper.drawImage(image, 0, 0);
	paper.fillStyle = '#111';
	paper.font = `${size}px system-ui, sans-serif`;
	lines.forEach((text, i) => paper.fillText(text, size, height + line * (i + 1), width - 2 * size));
	return new Promise((done) => canvas.toBlob(done));
}
