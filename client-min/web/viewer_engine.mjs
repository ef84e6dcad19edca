// The viewer's picture is drawn by a worker, so that neither decoding nor drawing keeps the page from its
// input; in a browser that has no canvas for workers, the page itself. Messages to it:
//
//   { type: 'open', url, token, first }             another scene; 'opened' brings what is said of it;
//                                                  first: EcoLayer's, or its body comes later:
//   { type: 'answer', body }                        that
//   { type: 'beside', url, token }                  a second scene of that place, right of `wipe`; url null: none. Then
//                                                  'besides', with what is said of it
//   { type: 'draw', number, matrix, eye, next, size, moving, vertices, bytes, tint, smooth, sun, shadows, haze, hide,
//     still, wipe }
//                                                  the view from now on; at rest its picture gets more
//                                                  samples, and 'sampled' says how many it has; 'paced' says
//                                                  by which factor its vertices should change
//   { type: 'find', text }                          plants of that species, column or row: 'found', of those in view the nearest,
//                                                  then others
//   { type: 'pick', at }                            what is seen there? 'picked', then of a plant 'identified':
//                                                  its row, and 'explained': why so. It is highlighted
//   { type: 'mark', plant }                         the same of another, by list and index, once it is in view; null: none
//   'named', once a picture is complete, brings the species that its plants stand for
//   { type: 'explain' }                             why is the picture what it is?
//   { type: 'save', compares }                      the next picture that is drawn with `still`, as a PNG, once it has
//                                                  all samples: 'saved', with its facts. `compares`: after 'comparing' it
//                                                  is drawn with all detail, too, and 'saved' has its `error` beside that
//   `pick` with `measures` says only what is there
//
// and from it these answers, 'drawn' with what there is to say of the picture, and 'failed'.
import { EcoLayer } from './eco_layer.mjs';
// what that imports, so that all of it is fetched at once
import { hasRows } from './eco_ask.mjs';
import './eco_client.mjs';
import './eco_keep.mjs';
import './eco_stream.mjs';

const PIXELS_MAX = 1.6e6;
// Samples are drawn in parts of as many vertices as take 20 ms, as input waits for the part under way. Smaller
// parts than these would take longer to wait for than to draw.
const PART_LEAST = 50000, PART_MOST = 1e9, PART_MS = 20;
// a moving picture, and the first one, may take so long; it has fewer pixels and no leaves for it
const MOVING_MS = 40, MOVING_LEAST = 0.25;
const PACE_PICTURES = 6, PACE_FACTOR = 1.5;      // so many in turn are late, or early, and the budget changes so
const FIND_BYTES = 100;          // of openapi.yaml's `text`
const STILL_SAMPLES = 64, REST_SAMPLES = 16;
const FULL_VERTICES = 2 ** 24, FULL_MS = 60000;          // of a picture that others are compared with: the most, and how long it may take
const NEAR_MOST = 5000, FOUND_MOST = 20, PIECE = 512;   // plants that are searched, and shown; rows that are asked for at once
const ROWS_MAX = 40;                             // of an explanation that are shown
const nextFrame = globalThis.requestAnimationFrame?.bind(globalThis) ?? ((f) => setTimeout(f, 16));

const between = (least, value, most) => Math.min(most, Math.max(least, value));
const pictureOf = (wanted) => JSON.stringify({ ...wanted, number: 0 });
const apart = (row, distance) => Math.abs(Math.log((row.distance_m ?? distance) / distance));

class Engine {
	constructor(canvas, post) {
		const attributes = { antialias: false, alpha: false, preserveDrawingBuffer: true };
		this.gl = canvas.getContext('webgl2', attributes);
		Object.assign(this, { canvas, post, layer: null, other: null, wanted: null, frame: false, stale: false,
			movingScale: 0.4, part: PART_LEAST, pictures: 0 });
		this.gl?.clearColor(0.55, 0.6, 0.65, 1);        // of the page, until there is a picture
		this.gl?.clear(this.gl.COLOR_BUFFER_BIT);
		if (!this.gl)
			this.fail('This browser has no WebGL 2, which the viewer draws with.');
		// another program, or sleep, may take what is on the GPU
		canvas.addEventListener('webglcontextlost', (event) => {
			event.preventDefault();
			this.fail('The graphics driver has lost the picture; waiting for it', true);
		});
		canvas.addEventListener('webglcontextrestored', () => this.opened && this.hear(this.opened));
	}

	fail(text, offline = false) {
		this.post({ type: 'failed', text, offline });
	}

	/** Draws with the next frame, the first picture at once; and once the picture before is there. */
	redraw() {
		this.stale = true;
		if (this.frame || !this.layer || !this.wanted || this.gl.isContextLost())
			return;
		this.frame = true;
		(this.drawn ? nextFrame : queueMicrotask)(async () => {
			this.stale = false;
			try {
				const since = performance.now(), { layer } = this;
				if (layer && this.draw()) {
					this.stale = !this.drawn;
					this.drawn = true;
					await this.finished();
					this.pace(performance.now() - since);
				}
				if (layer && layer === this.layer && !this.gl.isContextLost()) {
					if (!this.compares)
						this.tell();
					await this.offer();
					for (const each of this.layers())
						await this.refine(each);
				}
			} catch (error) {
				// the next one may do without what was refused, as shadows
				this.stale ||= error.message !== this.failed;
				this.failed = error.message;
				this.fail(error.message);
			} finally {
				this.frame = false;
				if (this.stale)
					this.redraw();
			}
		});
	}

	/** Waits until the GPU has drawn. */
	async finished() {
		const { gl } = this, fence = gl.fenceSync(gl.SYNC_GPU_COMMANDS_COMPLETE, 0);
		gl.flush();
		do
			await new Promise((done) => setTimeout(done, 1));
		while (fence && gl.getSyncParameter(fence, gl.SYNC_STATUS) === gl.UNSIGNALED);
		gl.deleteSync(fence);
	}

	layers() {
		return this.other ? [this.layer, this.other] : [this.layer];
	}

	/** Adds a sample to a picture at rest, unless something comes that is to be drawn; the next frame shows it. */
	async refine(layer) {
		const { sampled: before, refines } = layer;
		while (!this.stale && !this.wanted.moving && this.layers().includes(layer) && layer.sampled === before
				&& layer.refine(this.part)) {
			const since = performance.now();
			await this.finished();
			const change = between(0.5, PART_MS / (performance.now() - since), 2);
			this.part = between(PART_LEAST, this.part * change, PART_MOST);
		}
		this.stale ||= layer.sampled > before || layer.refines !== refines;
	}

	/** A moving picture has as many pixels as can be drawn in time. If the fewest are too many, or all of them take
	 * much less, picture after picture, the vertices are too many, or few. */
	pace(ms) {
		if (!this.wanted.moving)
			return;
		const late = this.movingScale === MOVING_LEAST && ms > 1.5 * MOVING_MS;
		const spends = this.said.facts?.vertices > this.wanted.vertices / 2;
		const early = spends && this.movingScale === 1 && ms < MOVING_MS / 3;
		this.pictures = late ? Math.min(0, this.pictures) - 1 : early ? Math.max(0, this.pictures) + 1 : 0;
		this.movingScale = between(MOVING_LEAST,
			this.movingScale * Math.sqrt(between(0.5, MOVING_MS / Math.max(ms, 1), 1.5)), 1);
		if (Math.abs(this.pictures) < PACE_PICTURES)
			return;
		this.post({ type: 'paced', factor: late ? 1 / PACE_FACTOR : PACE_FACTOR });
		this.pictures = 0;
	}

	answer({ body }) {
		this.answered?.(body);
	}

	async open({ url, token, first }) {
		this.opened = { type: 'open', url, token };
		if (first?.comes)
			first.body = new Promise((done) => { this.answered = done; });
		this.layer?.free();
		this.layer = null;
		await this.beside({ url: null });
		const onError = (error) => this.fail(error.message, error.offline), onChange = () => this.redraw();
		const layer = new EcoLayer({ url, token, first, gl: this.gl, keep: !token, onChange,
			onError });
		this.opening = layer;
		await layer.ready.catch((error) => {
			// of one that was left meanwhile nobody wants to know
			if (this.opening === layer)
				throw error;
		});
		if (this.opening !== layer)
			return layer.free();
		this.layer = layer;
		this.post({ type: 'opened', about: layer.about });
		this.redraw();
	}

	/** A second scene, which has the place of the first. */
	async beside({ url, token }) {
		this.other?.free();
		this.other = null;
		const main = this.layer, turn = this.turn = {};
		const layer = url ? new EcoLayer({ url, token, gl: this.gl, keep: !token, onChange: () => this.redraw(),
			onError: (error) => this.fail(error.message, error.offline) }) : null;
		await layer?.ready.catch((error) => {
			if (this.turn !== turn)
				return;
			layer.free();
			throw error;
		});
		if (this.turn !== turn || this.layer !== main)
			return layer?.free();
		this.other = layer;
		if (layer)
			this.post({ type: 'besides', about: layer.about });
		this.redraw();
	}

	/** The scene at a share of the picture's width. */
	at(x) {
		return this.other && x > this.wanted.wipe ? this.other : this.layer;
	}

	/** From the first scene's coordinates to those of another. */
	wayTo(layer) {
		const [from, to] = [this.layer, layer].map(({ about }) => about.origin?.at ?? [0, 0, 0]);
		return from.map((v, i) => v - to[i]);
	}

	/** Draws a scene by a camera of the first one's coordinates, between two shares of the width. */
	drawLayer(layer, clip) {
		const { matrix: m, eye, next, size } = this.wanted, way = this.wayTo(layer), moved = [...m];
		const shifted = (place) => place.map((v, i) => v + way[i]);
		for (let i = 0; i < 4; i++)
			moved[12 + i] -= m[i] * way[0] + m[4 + i] * way[1] + m[8 + i] * way[2];
		layer.clip = clip;
		return layer.draw(moved, shifted(eye), size, next && { eye: shifted(next.eye), target: shifted(next.target) });
	}

	/** False: nothing is here yet. */
	draw() {
		const { layer, other, gl, canvas, wanted } = this, { eye, size } = wanted;
		const first = !this.drawn, moving = wanted.moving || first;
		const [width, height] = size;
		if (canvas.width !== width || canvas.height !== height)
			Object.assign(canvas, { width, height });
		const { tint, smooth, sun, shadows, haze } = wanted, full = this.compares;
		const [vertices, bytes, detail] = full ? [this.saving.most, -1, this.saving.detail] : [wanted.vertices, wanted.bytes, ''];
		const scale = wanted.still ? 1 : Math.min(1, Math.sqrt(PIXELS_MAX / (width * height)));
		for (const each of this.layers()) {
			Object.assign(each, { vertices, bytes, detail, tint, smooth, sun, shadows, haze, moving, hurried: this.movingScale < 1,
				samples: wanted.still && !full ? STILL_SAMPLES : REST_SAMPLES, scale: moving ? scale * this.movingScale : scale });
			each.hide(wanted.hide).catch((error) => this.fail(error.message));
		}
		gl.bindFramebuffer(gl.FRAMEBUFFER, null);
		gl.viewport(0, 0, width, height);
		gl.clearDepth(1);
		gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
		const there = this.drawLayer(layer, [0, other ? wanted.wipe : 1]), { offline, stream } = layer;
		if (other)
			this.drawLayer(other, [wanted.wipe, 1]);
		const layers = this.layers(), complete = layers.every((each) => each.complete);
		this.said = { number: wanted.number, moving, facts: layer.facts(), complete: complete && !first, offline,
			sampled: Math.min(...layers.map(({ sampled }) => sampled)), more: layers.some(({ refines }) => refines),
			received: stream.received, ahead: layer.ahead,
			ground: stream.selected ? stream.ground(eye[0], eye[1]) : null };
		return there;
	}

	/** Says of what was drawn that it is there, and once it is complete, what stands there; of more samples
	 * only how many there are. */
	tell() {
		const { number, complete, sampled, more } = this.said;
		if (this.told === number && sampled > 1)
			return this.post({ type: 'sampled', sampled, more });
		this.told = complete ? number : null;
		this.post({ type: 'drawn', ...this.said });
		if (complete && this.named !== this.layer.stream)
			this.name(this.layer.stream);
		if (complete && this.sought)
			this.show(this.sought);
	}

	/** Without an answer plants keep the pack's names. */
	async name(stream) {
		this.named = stream;
		const species = await this.layer.species().catch(() => null);
		if (this.named === stream)
			this.post({ type: 'named', species });
	}

	mark({ plant }) {
		this.sought = plant;
		for (const layer of this.layers())
			layer?.mark(null);
		this.redraw();
	}

	/** Highlights a plant that was looked for, and says what is known of it, if it is in view. */
	show(plant) {
		const picked = this.layer.mark(plant);
		if (!picked)
			return;
		this.sought = null;
		this.redraw();
		this.describe(this.layer, picked).catch((error) => this.fail(error.message));
	}

	/** Plants whose species, model, columns or number of a row is looked for: the nearest of those in view, then others of
	 * the scene, in its order. */
	async find({ text }) {
		const { layer } = this, { stream } = layer ?? {}, found = [], words = text.toLowerCase(), known = new Set();
		this.finding = text;
		const add = (plant, said) => {
			const key = `${plant.list} ${plant.index}`;
			if (!known.has(key) && found.length < FOUND_MOST)
				found.push({ ...plant, said });
			known.add(key);
		};
		const near = text && stream?.selected ? stream.near(NEAR_MOST) : [];
		for (const plant of near) {
			const said = this.rowSaid(layer, await this.rowOf(stream, plant)), { species, cells = [] } = said;
			if (this.finding !== text || found.length === FOUND_MOST)
				break;
			const has = (name) => name?.toLowerCase().includes(words);
			if (/^\d+$/.test(text) ? String(said.row) === text || cells.includes(text) : [species, said.plant, ...cells].some(has))
				add(plant, said);
		}
		for (const one of text && stream ? await this.namesOf(layer, words) : [])
			for (let next = 0; next !== null && found.length < FOUND_MOST && this.finding === text;) {
				const answer = await stream.find(one, next, FOUND_MOST);
				for (const { list, index, number, foot, height_m, ...said } of answer.plants)
					add({ kind: 'plant', plant: said.plant, list, index, number, foot, height_m }, this.rowSaid(layer, said));
				({ next } = answer);
			}
		if (this.finding === text)
			this.post({ type: 'found', text, found });
	}

	/** Texts to ask for: where rows are not known, also the models that stand for a species of that name; none that the
	 * server refuses as too long. */
	async namesOf(layer, words) {
		const models = hasRows(layer.stream.url, layer.about) ? [] : await layer.species() ?? [];
		return [words, ...models.filter((model) => !model.plant.toLowerCase().includes(words)
			&& model.species.some(({ species: name }) => name?.toLowerCase().includes(words))).map(({ plant }) => plant)]
			.filter((one) => new TextEncoder().encode(one).length <= FIND_BYTES);
	}

	/** The server's description of a plant, from the pieces of rows that were asked for. */
	async rowOf(stream, { list, index }) {
		const first = index - index % PIECE, key = `${list} ${first}`;
		if (this.rows?.of !== stream)
			this.rows = { of: stream, pieces: new Map() };
		const { pieces } = this.rows;
		if (!pieces.has(key))
			pieces.set(key, stream.rows(list, first, PIECE).catch((error) => {
				pieces.delete(key);
				throw error;
			}));
		return (await pieces.get(key))[index - first];
	}

	async pick({ at, measures }) {
		if (!this.layer?.stream?.selected || !this.draw())
			return;
		const layer = this.at(at[0]), picked = layer.pick(...at);
		if (!picked)
			return;
		if (measures)
			this.mark({ plant: null });
		this.sought = null;
		this.redraw();
		return this.describe(layer, picked, measures);
	}

	/** Says what a thing is, a plant's row, and why it is drawn so; `measures`: only the first. */
	async describe(layer, picked, measures = false) {
		const { stream, about: { columns, tints } } = layer;
		Object.assign(picked, { columns, tints });
		for (const key of ['foot', 'at'])
			if (picked[key])
				picked[key] = picked[key].map((v, i) => v - this.wayTo(layer)[i]);
		this.post({ type: 'picked', picked });
		if (measures)
			return;
		if (picked.kind === 'plant')
			this.post({ type: 'identified', picked, plant: await this.rowSaid(layer, await stream.plant(picked)) });
		if (picked.cuts?.length)
			this.post({ type: 'explained', picked, reasons: await this.reasonsOf(stream, picked) });
	}

	/** Without rows the species of a plant is what its model stands for. */
	rowSaid({ stream, about }, { species, ...plant }) {
		return hasRows(stream.url, about) ? { species, ...plant } : plant;
	}

	/** The row of its distance for each cut that draws a plant: its text, and its vertices. */
	async reasonsOf(stream, { cuts, distance_m, scale }) {
		const { rows } = await stream.explain();
		const distance = distance_m / scale;
		return cuts.map(({ list, first, end, vertices }) => ({ ...rows
			.filter((row) => row.list === list && row.first === first && row.end === end)
			.sort((a, b) => apart(a, distance) - apart(b, distance))[0], vertices }));
	}

	/** The picture's rows, those of most vertices first, and what its vertices are spent on: by kind of reason. */
	async explain() {
		if (!this.layer?.stream?.selected)
			return;
		const { lambda, rows } = await this.layer.stream.explain(), spent = {};
		rows.sort((a, b) => b.vertices - a.vertices);
		for (const { why, vertices } of rows)
			spent[why] = (spent[why] ?? 0) + vertices;
		this.post({ type: 'explained', lambda, spent, more: Math.max(0, rows.length - ROWS_MAX),
			rows: rows.slice(0, ROWS_MAX) });
	}

	/** The next picture that is whole is saved: not a coarse one of a motion, nor an incomplete one, nor one that
	 * gets more samples. */
	save({ compares }) {
		this.saving = { compares, since: performance.now() };
		this.redraw();
	}

	/** It is drawn with all detail, and compared with what is saved: until then nothing else is told of pictures. */
	get compares() {
		return Boolean(this.saving?.blob) && this.wanted.still;
	}

	async offer() {
		const { saving } = this, { moving, complete, offline, facts } = this.said, layers = this.layers();
		const late = this.compares && performance.now() - saving.since > 2 * FULL_MS;
		// both pictures are compared with so many samples, as those of all detail take long
		if (saving?.compares && !saving.blob && this.said.sampled === REST_SAMPLES) {
			layers.forEach((layer) => layer.compare());
			saving.kept = true;
		}
		if (!saving || !this.wanted.still || moving || !late && (!(complete || offline) || layers.some(({ refines }) => refines)))
			return;
		if (this.compares)
			return this.give({ ...saving, error: late || offline ? null : this.errorOf(layers, saving) });
		const { canvas, wanted } = this;
		const blob = canvas.convertToBlob ? await canvas.convertToBlob()
			: await new Promise((done) => canvas.toBlob(done));
		const full = saving.kept && complete && await Promise.all(layers.map(({ stream }) => stream.fullVertices())).catch(() => null);
		if (!full || pictureOf(wanted) !== pictureOf(this.wanted))
			return this.give({ ...saving, blob, facts });
		// as many as this device draws in time, by the time that the picture took
		const since = performance.now(), times = STILL_SAMPLES / REST_SAMPLES * FULL_MS / (since - saving.since);
		const most = Math.round(Math.min(FULL_VERTICES, Math.max(2, times) * facts.vertices));
		Object.assign(saving, { blob, facts, since, most, detail: Math.max(...full) <= most ? 'all' : 'more' });
		this.post({ type: 'comparing' });
		setTimeout(() => this.redraw(), 2 * FULL_MS + 1);        // it is late then, even where nothing more comes
		this.redraw();
	}

	give(saved) {
		this.saving = null;
		this.post({ type: 'saved', ...saved });
	}

	/** The error of a picture beside those that are drawn now, of two scenes that of the worse one: { picture_error, m16,
	 * vertices, full }; null: they are not here. */
	errorOf(layers, { detail, facts: before }) {
		const errors = layers.map((layer) => layer.arrived && layer.compare()), { vertices } = layers[0].facts();
		const full = detail === 'all' && layers.every((layer) => layer.about.cap_vertices === null && layer.facts().coarse === 0);
		return errors.every(Boolean) && (full || vertices > before.vertices)
			? { ...errors.reduce((a, b) => a.picture_error > b.picture_error ? a : b), vertices, full } : null;
	}

	async hear(message) {
		if (!this.gl)
			return;
		try {
			if (message.type === 'draw') {
				// another picture is compared anew
				if (this.saving && pictureOf(message) !== pictureOf(this.wanted))
					Object.assign(this.saving, { blob: null, kept: false, since: performance.now() });
				this.wanted = message;
				this.redraw();
			} else {
				await this[message.type](message);
			}
		} catch (error) {
			this.fail(error.message);
		}
	}
}

/** Draws to `canvas` as `port` says. */
export function startEngine(canvas, port) {
	const engine = new Engine(canvas, (message) => port.postMessage(message));
	port.onmessage = ({ data }) => engine.hear(data);
	return engine;
}

EcoLayer.prepare();
if (globalThis.WorkerGlobalScope)
	globalThis.onmessage = ({ data }) => { globalThis.engine = startEngine(data.canvas, globalThis); };
