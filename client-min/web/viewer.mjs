// The viewer at /: which scene, where the camera is, and what people ask of it. All of it is in the address
// (#scene=...), so that a link shows what its sender saw. A worker makes the picture (viewer_engine.mjs).
import { Camera, cameraKeys, withModifier } from './viewer_camera.mjs';
import { readLink, writeLink } from './viewer_link.mjs';
import { nameSpecies, number, showFacts, showLegend, showNorth, showPicked, showPlant, showReasons, showScale,
	showWhy } from './viewer_panel.mjs';

const $ = (id) => document.getElementById(id);
const canvas = $('picture');
const camera = new Camera();
const settings = { scene: '', mode: 'orbit', vertices: 300000, bytes: -1, kind: 0, smooth: 0, sun: '',
	shadows: 'perspective' };
const STILL_MS = 250, LOADING_MS = 300;
const AHEAD_S = 1;                       // what a moving camera will need so soon is asked for, too
let engine = null, about = null, settled = true, frame = 0, movedAt = -Infinity, recording = null;
let token = null;                        // of a scene that is not for all: #scene=NAME&token=TOKEN
let asked = 0, drawn = null, picked = null, view = null, incompleteSince = 0, wasOffline = false;
let faults = [], sunIsLinked = false;    // what the address has that cannot be read; whether it has a sun
let located = null;                      // the scene whose coordinates the camera has

const say = (text, error = false) => {
	$('state').textContent = text;
	$('state').classList.toggle('error', error);
};

// ---- The address ----

function readAddress() {
	const { values, faults: found } = readLink(location.hash), { token: given = token, view: at = null } = values;
	for (const key of Object.keys(settings))
		settings[key] = values[key] ?? settings[key];
	[token, view, faults] = [given, at, found];
	sunIsLinked = Boolean(values.sun);
}

/** The usual time of the sun (view_sun_usual), in UTC: ten in the morning of midsummer. */
function usualSun() {
	const { longitude_deg: longitude, latitude_deg: latitude } = about?.origin ?? {};
	const ms = Date.UTC(new Date().getUTCFullYear(), latitude < 0 ? 11 : 5, 21, 10) - longitude * 240000;
	return Number.isFinite(ms) ? new Date(ms).toISOString().slice(0, 16) : '';
}

const hasPlace = () => about?.origin?.longitude_deg !== undefined;

function sayFaults() {
	const noSun = sunIsLinked && about && !hasPlace()
		? ["The link's sun is not used: the scene has no CRS, so its place on Earth is unknown."] : [];
	if (faults.length || noSun.length)
		say([...faults, ...noSun].join(' '), true);
}

function writeAddress() {
	// before a scene is known the camera looks nowhere
	if (about)
		history.replaceState(null, '', writeLink(settings, camera.view()));
}

// ---- Pictures ----

/** Says to the head of the next visit's page that something of a scene is kept. */
function remember(name) {
	try {
		localStorage.setItem(`kept ${name}`, 1);
	} catch {
		// then it asks for more than it needs
	}
}

/** The engine: a worker's where canvases can be given away, else this page's. */
async function startEngine() {
	const worker = globalThis.engine;
	if (!worker) {
		const { port1, port2 } = new MessageChannel();
		(await import('./viewer_engine.mjs')).startEngine(canvas, port2);
		return port1;
	}
	const offscreen = canvas.transferControlToOffscreen();
	worker.onerror = () => say('The viewer could not be loaded; reload the page to try again.', true);
	if (worker.failed)
		worker.onerror();
	worker.postMessage({ canvas: offscreen }, [offscreen]);
	return worker;
}

/** The place where a moving camera will soon be: as it went on since the last frame; null: it stands. */
function nextView(now, moving) {
	const { eye, target } = camera.view(), { last } = nextView, s = (now - last?.now) / 1000;
	nextView.last = moving ? { now, eye, target } : null;
	if (!moving || !(s > 0 && s < STILL_MS / 1000))
		return nextView.given = null;
	const on = (to, from) => to.map((v, i) => v + (v - from[i]) / s * AHEAD_S);
	const next = { eye: on(eye, last.eye), target: on(target, last.target) };
	const far = Math.hypot(...next.eye.map((v, i) => v - next.target[i]));
	// between two moves of a pointer it goes on as before
	if (!next.eye.every((v, i) => v === eye[i]) || !next.target.every((v, i) => v === target[i]))
		nextView.given = far > camera.near ? next : null;
	return nextView.given;
}

const redraw = () => { frame ||= requestAnimationFrame(draw); };

function draw(now) {
	frame = 0;
	if (camera.step(now))
		moved();
	const moving = camera.moving() || now - movedAt < STILL_MS;
	if (moving)
		redraw();
	const ratio = Math.min(devicePixelRatio, 2);
	const size = [canvas.clientWidth, canvas.clientHeight].map((n) => Math.max(1, Math.round(n * ratio)));
	const { vertices, bytes, kind, smooth, shadows } = settings, sun = Date.parse(`${settings.sun}Z`) / 1000;
	const convergence = (about?.origin?.convergence_deg ?? 0) * Math.PI / 180;
	showScale(camera.metresAcross() / canvas.clientHeight, camera.heading() + convergence);
	if (!about)
		return;
	engine.postMessage({ type: 'draw', number: ++asked, matrix: camera.matrix(size[0] / size[1]), size,
		moving, eye: camera.view().eye, next: nextView(now, moving), vertices, bytes, shadows, sun: sun || null,
		tint: kind ? 'kind' : 'none', smooth: !!smooth, haze: camera.haze() });
}

function moved() {
	movedAt = performance.now();
	canvas.dataset.complete = false;
	clearTimeout(moved.timer);
	moved.timer = setTimeout(writeAddress, 300);
	redraw();
}

function lookAt(box, whole = false) {
	camera.setMode('orbit');
	camera.frame(box, canvas.clientWidth / canvas.clientHeight, whole);
	camera.setMode(settings.mode);           // a walker looks ahead
	moved();
}

// ---- What the engine says ----

function showProgress({ complete, offline, received }) {
	// what a server did not answer is no error any more once it does
	if (offline)
		return;
	if (wasOffline)
		say('');
	wasOffline = false;
	const complained = $('state').classList.contains('error');
	if (complete) {
		incompleteSince = 0;
		if (!complained)
			say('');
		return;
	}
	incompleteSince ||= performance.now();
	if (!complained && performance.now() - incompleteSince > LOADING_MS)
		say(`Loading, ${number(received)} bytes so far`);
}

/** Takes a scene: from now on views of it are asked for. The camera stays if the scene before lies at the same
 * place. */
function know(said) {
	about = said;
	showSettings();
	document.title = `${about.title ?? settings.scene} – ecostream`;
	$('draft').hidden = !about.draft;
	showLegend(about.tints);
	camera.reach(about.bounds, about.near_m);
	const stays = !view && located && camera.transfer(located, about);
	located = about;
	if (!stays)
		lookAt(about.look);
	if (view)
		camera.look(...view);
	settled = Boolean(view);
	sayFaults();
	moved();
}

/** Another may have been clicked meanwhile. */
const isPicked = ({ list, index }) => picked?.list === list && picked?.index === index;

const heard = {
	opened(message) {
		if (!token)
			remember(settings.scene);
		if (message.about.id !== about?.id)
			know(message.about);
	},
	drawn(message) {
		drawn = message;
		showProgress(message);
		if (message.facts && !$('panel').hidden)
			showFacts(message.facts);
		if (settings.mode === 'walk' ? camera.stand(message.ground ?? about.bounds.low[2])
			: !settled && message.ground !== null && camera.lift(message.ground))
			redraw();
		settled ||= message.complete;
		canvas.dataset.complete = message.complete && message.number === asked && !frame;
		canvas.dataset.samples = message.sampled;
	},
	sampled({ sampled, more }) {
		canvas.dataset.samples = sampled;
		drawn.more = more;
	},
	named({ species }) {
		nameSpecies(species);
		if (drawn?.facts && !$('panel').hidden)
			showFacts(drawn.facts);
	},
	picked(message) {
		({ picked } = message);
		showPicked(picked, about.origin);
	},
	identified({ picked: of, plant }) {
		if (isPicked(of))
			showPlant(plant);
	},
	explained({ reasons, picked: of, ...why }) {
		if (reasons && isPicked(of))
			showReasons(reasons);
		else if (!reasons)
			showWhy(why);
	},
	saved({ blob }) {
		save(`${settings.scene}.png`, blob);
		if (!$('state').classList.contains('error'))
			say('');
	},
	failed({ text, offline }) {
		wasOffline = offline;
		say(text, true);
	},
};

// ---- Scenes and settings ----

/** The answer that the page's head asked for (viewer_first.js), for the engine; null where that is no longer wanted, or
 * went wrong: then the engine asks by itself. What the scene is, the page knows before the engine. */
async function takeFirst(name) {
	const { scene, about, answer, view, wanted } = globalThis.first ?? {};
	globalThis.first = null;
	if (scene !== name || token)
		return null;
	try {
		const said = await about, described = said.ok ? await said.json() : null;
		if (!described || settings.scene !== name)
			return null;
		know(described);
		return { about: described, view, wanted, body: answer && bytesOf(answer, modifiedOf(said)) };
	} catch {
		return null;
	}
}

const modifiedOf = (answer) => answer.headers.get('last-modified');

/** An answer's bytes, which are of the pack that is described; or null. In one piece: as a stream each part
 * of it would wait for this page's thread. */
async function bytesOf(answer, modified) {
	const came = await answer.catch(() => null);
	const good = came?.status === 200 && modifiedOf(came) === modified;
	return good ? came.arrayBuffer().catch(() => null) : null;
}

/** The engine opens the scene while its first answer is on its way. */
async function sendOpen(message, first) {
	engine.postMessage({ ...message, first: first && { ...first, body: null, comes: !!first.body } });
	if (!first?.body)
		return;
	const body = await first.body;
	engine.postMessage({ type: 'answer', body }, body ? [body] : []);
}

function open(name) {
	settings.scene = name;
	about = null;
	if (!name)
		return;
	closeCard();
	say('Loading');
	const url = new URL(`v1/scenes/${encodeURIComponent(name)}`, location.href).href, opened = token;
	takeFirst(name).then((first) => {
		if (settings.scene === name)
			sendOpen({ type: 'open', url, token: opened }, first);
	});
}

function showSettings() {
	$('vertices').value = Math.log2(settings.vertices);
	$('vertices-text').textContent = number(settings.vertices);
	$('bytes').value = settings.bytes < 0 ? $('bytes').max : Math.log2(settings.bytes);
	$('bytes-text').textContent = settings.bytes < 0 ? 'no limit' : number(settings.bytes);
	$('kind').checked = settings.kind;
	$('sun').value = settings.sun || usualSun();
	$('shadows').value = settings.shadows;
	$('sun').disabled = about && !hasPlace();
	$('sun-note').hidden = !$('sun').disabled;
	showNorth(Boolean(about?.origin));
	camera.setMode(settings.mode);
	$('mode').value = settings.mode;
	moved();
}

function set(key, value) {
	settings[key] = value;
	showSettings();
}

function togglePanel() {
	$('panel').hidden = !$('panel').hidden;
	$('panel-button').setAttribute('aria-expanded', !$('panel').hidden);
	if (!$('panel').hidden && drawn?.facts)
		showFacts(drawn.facts);
}

/** By its key the menu also takes the focus, and gives it back to the picture. */
function pressPanel() {
	togglePanel();
	($('panel').hidden ? canvas : $('panel')).focus();
}

/** Colours by representation, with their legend. */
function showKinds(on) {
	set('kind', on ? 1 : 0);
	if (on && $('panel').hidden)
		togglePanel();
}

function closeCard() {
	$('card').hidden = true;
	picked = null;
}

/** The thing that is seen at a place of the picture; without a place, in its middle. */
function pick(at = [0.5, 0.5]) {
	if (about)
		engine.postMessage({ type: 'pick', at });
}

/** Looks at what was clicked, from where a plant fills much of the picture. */
function orbitPicked() {
	const { foot, at, height_m: height = 0 } = picked, target = foot ? [...foot] : at;
	target[2] += height / 2;
	camera.approach(target, height * 2);
	set('mode', 'orbit');
	canvas.focus();
}

function save(name, blob) {
	const href = URL.createObjectURL(blob);
	Object.assign(document.createElement('a'), { download: name, href }).click();
	setTimeout(() => URL.revokeObjectURL(href), 1000);
}

function savePicture() {
	if (canvas.dataset.complete !== 'true' || drawn.more)
		say('The picture is saved once all of it is here');
	engine.postMessage({ type: 'save' });
}

async function copyLink() {
	writeAddress();
	// only pages of this machine or by TLS may write to the clipboard
	const copied = await navigator.clipboard?.writeText(location.href).then(() => true, () => false);
	say(copied ? 'Link copied' : `The link is this page's address: ${location.href}`);
}

function showWhole() {
	if (about)
		lookAt(about.bounds, true);
}

/** Two views a second until it is pressed again: a camera script that ecoview replays. */
function record() {
	if (!recording) {
		const since = performance.now(), keyframes = [];
		const take = () => keyframes.push({ time_s: (performance.now() - since) / 1000,
			...camera.view() });
		take();
		recording = { keyframes, take, timer: setInterval(take, 500) };
	} else {
		clearInterval(recording.timer);
		recording.take();
		const script = JSON.stringify({ fps: 2, keyframes: recording.keyframes }, null, 1);
		save(`${settings.scene}.camera.json`, new Blob([script], { type: 'application/json' }));
		recording = null;
	}
	$('record').setAttribute('aria-pressed', !!recording);
	$('record').textContent = recording ? 'Stop' : 'Record';
}

const shortcuts = {
	c: () => showKinds(!settings.kind), p: savePicture, r: record, i: () => pick(), l: copyLink,
	h: showWhole,
};

/** Reads the address: at first, and when a link is pasted over it. `scenes`: names; before they are
 * known the scene that the address names is taken on trust, so that its picture comes sooner. */
function goToAddress(scenes) {
	const before = settings.scene;
	readAddress();
	const named = settings.scene, known = !scenes || scenes.includes(named) || token;
	if (!known)
		[settings.scene] = scenes;
	$('scene').value = settings.scene;
	if (settings.scene !== before)
		open(settings.scene);
	else if (view && about)
		camera.look(...view);
	showSettings();
	if (!known && named)
		faults.push(`This server has no scene ${named}; this is ${settings.scene}.`);
	sayFaults();
}

async function start() {
	engine = await startEngine();
	engine.onmessage = ({ data }) => heard[data.type](data);
	goToAddress(null);
	const answer = await fetch('v1/scenes').catch(() => null);
	if (!answer?.ok)
		return say('The server does not answer; reload the page to try again.', true);
	const { scenes } = await answer.json(), names = scenes.map(({ name }) => name);
	if (token && !names.includes(settings.scene))
		names.push(settings.scene);
	if (!names.length)
		return say('This server has no scenes.', true);
	$('scene').replaceChildren(...names.map((name) => new Option(name)));
	addEventListener('hashchange', () => {
		say('');
		goToAddress(names);
	});
	goToAddress(names);
}

camera.listen(canvas, moved, pick);
addEventListener('resize', moved);
addEventListener('keydown', (event) => {
	const key = event.key.toLowerCase(), typing = event.target.matches('select, input:not([type=checkbox])');
	if (withModifier(event) || (typing && key !== 'escape'))
		return;
	if (key === 'escape' && picked)
		closeCard();
	else if (key === 'escape')
		pressPanel();
	else if (shortcuts[key] && !cameraKeys.has(key))
		shortcuts[key]();
});
$('panel-button').onclick = togglePanel;
$('scene').onchange = () => {
	[view, faults, sunIsLinked] = [null, [], false];
	// so that the browser's way back leads to the scene before
	clearTimeout(moved.timer);
	writeAddress();
	history.pushState(null, '', `#scene=${encodeURIComponent($('scene').value)}`);
	open($('scene').value);
};
$('mode').onchange = () => set('mode', $('mode').value);
$('vertices').oninput = () => set('vertices', Math.round(2 ** $('vertices').value));
$('bytes').oninput = () => {
	const { value, max } = $('bytes');
	set('bytes', value === max ? -1 : Math.round(2 ** value));
};
$('kind').onchange = () => showKinds($('kind').checked);
$('sun').onchange = () => set('sun', $('sun').value);
$('shadows').onchange = () => set('shadows', $('shadows').value);
$('whole').onclick = showWhole;
$('save').onclick = savePicture;
$('link').onclick = copyLink;
$('record').onclick = record;
$('explain').onclick = () => engine.postMessage({ type: 'explain' });
$('card-orbit').onclick = orbitPicked;
$('card-close').onclick = closeCard;
$('state').onclick = () => say('');
start().catch((error) => say(error.message, true));
// for tests and for the curious
globalThis.viewer = { camera, settings, get about() { return about; }, get drawn() { return drawn; }, get picked() { return picked; } };
