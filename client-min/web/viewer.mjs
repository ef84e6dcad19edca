// The viewer at /: which scene, where the camera is, and what is said about the picture. All of it is in the
// address (#scene=...), so that a link shows what its sender saw. The picture itself is EcoLayer's.
import { EcoLayer } from './eco_layer.mjs';
import { Camera, cameraKeys, withModifier } from './viewer_camera.mjs';

const $ = (id) => document.getElementById(id);
const canvas = $('picture');
const gl = canvas.getContext('webgl2', { antialias: false, alpha: false, preserveDrawingBuffer: true });
const camera = new Camera();
const settings = { scene: '', mode: 'orbit', vertices: 300000, bytes: -1, kind: 0 };
const MOVING_SCALE = 0.4, STILL_MS = 250, PIXELS_MAX = 1.6e6;
let layer = null, frame = 0, movedAt = -Infinity, recording = null;

const say = (text, error = false) => {
	$('state').textContent = text;
	$('state').classList.toggle('error', error);
};
const number = (n) => {
	if (n >= 1e6)
		return `${(n / 1e6).toFixed(2)} M`;
	return n >= 1e4 ? `${(n / 1e3).toFixed(0)} k` : `${Math.round(n)}`;
};
const tint = () => settings.kind ? 'kind' : 'none';

// ---- The address ----

function readAddress() {
	const given = new URLSearchParams(location.hash.slice(1));
	for (const key of ['scene', 'mode'])
		settings[key] = given.get(key) ?? settings[key];
	for (const key of ['vertices', 'bytes', 'kind'])
		if (given.has(key) && Number.isFinite(Number(given.get(key))))
			settings[key] = Number(given.get(key));
	const view = ['eye', 'target'].map((key) => (given.get(key) ?? '').split(',').map(Number));
	return view.every((v) => v.length === 3 && v.every(Number.isFinite)) ? view : null;
}

function writeAddress() {
	const text = (v) => v.map((n) => Number(n.toFixed(3))).join(',');
	const { eye, target } = camera.view();
	const parts = { ...settings, eye: text(eye), target: text(target) };
	const pairs = Object.entries(parts).map(([key, value]) => `${key}=${value}`);
	history.replaceState(null, '', `#${pairs.join('&')}`);
}

// ---- Pictures ----

const redraw = () => { frame ||= requestAnimationFrame(draw); };

/** While the camera moves pictures are smaller, so that it moves at once. */
function pictureScale(now) {
	const pixels = canvas.width * canvas.height;
	return Math.min(1, Math.sqrt(PIXELS_MAX / pixels)) * (now - movedAt < STILL_MS ? MOVING_SCALE : 1);
}

function draw(now) {
	frame = 0;
	const ratio = Math.min(devicePixelRatio, 2);
	const [width, height] = [canvas.clientWidth, canvas.clientHeight]
		.map((n) => Math.max(1, Math.round(n * ratio)));
	if (canvas.width !== width || canvas.height !== height)
		Object.assign(canvas, { width, height });
	if (camera.step(now))
		movedAt = now;
	if (camera.moving() || now - movedAt < STILL_MS)
		redraw();
	if (!layer)
		return;
	layer.scale = pictureScale(now);
	gl.bindFramebuffer(gl.FRAMEBUFFER, null);
	gl.viewport(0, 0, width, height);
	gl.clearDepth(1);
	gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
	try {
		layer.draw(camera.matrix(width / height), camera.view().eye, [width, height]);
	} catch (error) {
		say(error.message, true);
	}
	showFacts();
	canvas.dataset.complete = layer.complete && now - movedAt >= STILL_MS;
}

function moved() {
	movedAt = performance.now();
	clearTimeout(moved.timer);
	moved.timer = setTimeout(writeAddress, 300);
	redraw();
}

// ---- What is said about it ----

const item = (...cells) => {
	const li = document.createElement('li');
	li.append(...cells);
	return li;
};
const span = (text) => Object.assign(document.createElement('span'), { textContent: text });
const metres = (length) => `${length.toFixed(1)} m`;

/** A table's row of cells. */
function row(texts) {
	const tr = document.createElement('tr');
	for (const text of texts)
		tr.insertCell().textContent = text;
	return tr;
}

function swatch([r, g, b]) {
	const box = Object.assign(document.createElement('span'), { className: 'swatch' });
	box.style.background = `rgb(${r} ${g} ${b})`;
	return box;
}

function showFacts() {
	showScale();
	const facts = layer.facts();
	if (!facts || $('panel').hidden)
		return;
	const figures = [
		['Vertices', number(facts.vertices)],
		['Plants in view', number(facts.plants)],
		['Predicted Q', facts.predicted_q?.toFixed(3) ?? '–'],
		['Bytes so far', number(facts.bytes)],
		['Decoded', `${(facts.memory_bytes / 2 ** 20).toFixed(1)} MiB`],
	];
	$('figures').replaceChildren(...figures.map(row));
	$('roles').replaceChildren(...facts.roles.filter((role) => role.vertices).map((role) =>
		item(swatch(role.color), span(role.name), span(number(role.vertices)))));
	$('species').replaceChildren(...facts.species.sort((a, b) => b.count - a.count).map((plant) =>
		item(span(plant.name), span(metres(plant.height_m)), span(`× ${number(plant.count)}`))));
}

function lengthText(length) {
	if (length >= 1000)
		return `${length / 1000} km`;
	return length >= 1 ? `${length} m` : `${Math.round(length * 100)} cm`;
}

/** A length at the distance of what is looked at, and where north (+Y) is. */
function showScale() {
	const pixel = camera.metresAcross() / canvas.clientHeight, most = pixel * 120;
	const unit = 10 ** Math.floor(Math.log10(most));
	const length = unit * [5, 2, 1].find((n) => n * unit <= most);
	$('scale-bar').style.width = `${length / pixel}px`;
	$('scale-text').textContent = lengthText(length);
	$('north').style.transform = `rotate(${-camera.heading() * 180 / Math.PI}deg)`;
}

// ---- Scenes and settings ----

async function open(name, view) {
	layer?.free();
	settings.scene = name;
	say('');
	const url = new URL(`/v1/scenes/${name}`, location.href).href;
	const answer = await fetch(url);
	if (!answer.ok) {
		const problem = await answer.json().catch(() => null);
		return say(problem?.detail ?? `${url}: ${answer.status}`, true);
	}
	const about = await answer.json();
	document.title = `${about.title ?? name} – ecostream`;
	camera.frame(about.bounds, about.near_m);
	if (view)
		camera.look(...view);
	const { vertices, bytes } = settings, onError = (error) => say(error.message, true);
	layer = new EcoLayer({ url, gl, vertices, bytes, tint: tint(), onChange: redraw, onError });
	await layer.ready;
	moved();
}

function showBudgets() {
	$('vertices').value = Math.log2(settings.vertices);
	$('vertices-text').textContent = number(settings.vertices);
	$('bytes').value = settings.bytes < 0 ? $('bytes').max : Math.log2(settings.bytes);
	$('bytes-text').textContent = settings.bytes < 0 ? 'no limit' : number(settings.bytes);
	$('kind').checked = settings.kind;
	$('mode').value = camera.mode = settings.mode;
	const { vertices, bytes } = settings;
	if (layer)
		Object.assign(layer, { vertices, bytes, tint: tint() });
	moved();
}

function set(key, value) {
	settings[key] = value;
	showBudgets();
}

function togglePanel() {
	$('panel').hidden = !$('panel').hidden;
	$('panel-button').setAttribute('aria-expanded', !$('panel').hidden);
	redraw();
}

function save(name, blob) {
	const href = URL.createObjectURL(blob);
	Object.assign(document.createElement('a'), { download: name, href }).click();
	setTimeout(() => URL.revokeObjectURL(href), 1000);
}

const savePicture = () => canvas.toBlob((blob) => save(`${settings.scene}.png`, blob));

async function copyLink() {
	writeAddress();
	await navigator.clipboard?.writeText(location.href)
		.then(() => say('Link copied'), () => say(location.href));
}

/** Two views a second until it is pressed again: a camera script that ecoview replays. */
function record() {
	if (!recording) {
		const since = performance.now(), keyframes = [];
		const seconds = () => (performance.now() - since) / 1000;
		const take = () => keyframes.push({ time_s: seconds(), ...camera.view() });
		take();
		recording = { keyframes, timer: setInterval(take, 500) };
	} else {
		clearInterval(recording.timer);
		const script = JSON.stringify({ fps: 2, keyframes: recording.keyframes }, null, 1);
		save(`${settings.scene}.camera.json`, new Blob([script], { type: 'application/json' }));
		recording = null;
	}
	$('record').setAttribute('aria-pressed', !!recording);
	$('record').textContent = recording ? 'Stop' : 'Record';
}

const shortcuts = { c: () => set('kind', settings.kind ? 0 : 1), p: savePicture, r: record };

async function start() {
	if (!gl)
		return say('This browser has no WebGL 2, which the viewer draws with.', true);
	const view = readAddress();
	const { scenes } = await (await fetch('/v1/scenes')).json();
	$('scene').replaceChildren(...scenes.map(({ name }) => new Option(name)));
	const name = scenes.some((scene) => scene.name === settings.scene) ? settings.scene : scenes[0]?.name;
	if (!name)
		return say('This server has no scenes.', true);
	$('scene').value = name;
	showBudgets();
	await open(name, view);
}

camera.listen(canvas, moved);
addEventListener('resize', redraw);
addEventListener('keydown', (event) => {
	if (withModifier(event) || event.target.matches('select, input[type=range]'))
		return;
	const key = event.key.toLowerCase();
	if (key === 'escape')
		togglePanel();
	else if (shortcuts[key] && !cameraKeys.has(key))
		shortcuts[key]();
});
$('panel-button').onclick = togglePanel;
$('scene').onchange = () => open($('scene').value);
$('mode').onchange = () => set('mode', $('mode').value);
$('vertices').oninput = () => set('vertices', Math.round(2 ** $('vertices').value));
$('bytes').oninput = () => {
	const { value, max } = $('bytes');
	set('bytes', value === max ? -1 : Math.round(2 ** value));
};
$('kind').onchange = () => set('kind', $('kind').checked ? 1 : 0);
$('save').onclick = savePicture;
$('link').onclick = copyLink;
$('record').onclick = record;
start().catch((error) => say(error.message, true));
// for tests and for the curious
globalThis.viewer = { camera, settings, get layer() { return layer; } };
