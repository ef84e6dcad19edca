// A scene as a layer of a page that draws with WebGL 2:
//
//   import { EcoLayer } from '/viewer/eco_layer.mjs';
//   const layer = new EcoLayer({ url: 'http://host:8080/v1/scenes/NAME', gl, onChange: redraw });
//   await layer.ready;
//   layer.draw(viewProjection, eye, [width, height]);        // in each frame
//
// The page owns the context, the camera and the clock. `viewProjection` takes metres from the scene's origin
// (Z up) to clip space, column by column as WebGL has matrices, of a camera that looks straight through the
// middle of the picture; `eye` is in metres, too. Drawing asks the server for what the view needs, as often
// as it changes; `onChange` says that there is more to be drawn. The page's own drawing hides the plants,
// and is hidden by them, by the depth buffer of the bound framebuffer; state that is changed is put back.
import createClient from './eco_client.mjs';
import { EcoKeep } from './eco_keep.mjs';
import { aboutScene, EcoError, EcoStream, isOffline } from './eco_stream.mjs';

export { EcoError };
export const TINTS = { none: 0, kind: 1 };
export const SHADOWS = { none: 0, standard: 1, perspective: 2 };
const SUMMARIES = -1, GROUND = -2;       // web_client.h

// a view that is out of date is given up when something of it came so long ago: else who moves on a slow line
// would never get anything
const PATIENCE_MS = 400;
const SAMPLES_MAX = 64;          // lod_eye_sample has so many places in a pixel
const FIRST_MS = 250;            // coarser pictures are shown while a view takes longer than this


let compiled = null;             // the client, which all layers share

/** Compiles the client while it comes; from hosts that do not say that it is WebAssembly, once it has. */
function compileClient() {
	const url = new URL('eco_client.wasm', import.meta.url);
	compiled ??= WebAssembly.compileStreaming(fetch(url))
		.catch(async () => WebAssembly.compile(await (await fetch(url)).arrayBuffer()));
	return compiled;
}

const instantiateWasm = (imports, done) => {
	compileClient().then((client) => WebAssembly.instantiate(client, imports)).then(done);
	return {};
};

const AGAIN_MS = 2000;           // a server that does not answer is asked again after so long
const TURN = 0.5;                // cosine between ways; who turns by more wants other things next

const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const row = (m, i) => [m[i], m[4 + i], m[8 + i]];
const same = (a, b) => JSON.stringify(a) === JSON.stringify(b);

/** Camera and depths of a perspective matrix: clip.w is the distance forward, clip.y up, and clip.z is
 * scale * distance + offset. */
export function cameraOf(m, eye) {
	const forward = row(m, 3), up = row(m, 1), z = row(m, 2), size = Math.hypot(...up);
	return {
		view: {
			eye: [...eye],
			target: eye.map((v, i) => v + forward[i]),
			up: up.map((v) => v / size),
			fov_y_deg: 2 * Math.atan(Math.hypot(...forward) / size) * 180 / Math.PI,
		},
		depth: [0.5 + 0.5 * dot(z, forward) / dot(forward, forward), 0.5 * (dot(z, eye) + m[14])],
	};
}

/** Whether one goes the way of the other: lists of numbers, or null of who stands. */
const alike = (a, b) => a && b
	&& a.reduce((sum, v, i) => sum + v * b[i], 0) > TURN * Math.hypot(...a) * Math.hypot(...b);

const cross = ([a, b, c], [x, y, z]) => [b * z - c * y, c * x - a * z, a * y - b * x];

/** A page's state of drawing, and how to put it back. */
function stateOf(gl) {
	const caps = [gl.BLEND, gl.CULL_FACE, gl.DEPTH_TEST, gl.DITHER, gl.SCISSOR_TEST, gl.STENCIL_TEST]
		.map((cap) => [cap, gl.isEnabled(cap)]);
	const framebuffer = gl.getParameter(gl.FRAMEBUFFER_BINDING);
	const program = gl.getParameter(gl.CURRENT_PROGRAM);
	const vertices = gl.getParameter(gl.VERTEX_ARRAY_BINDING);
	const unit = gl.getParameter(gl.ACTIVE_TEXTURE);
	const func = gl.getParameter(gl.DEPTH_FUNC);
	const mask = gl.getParameter(gl.DEPTH_WRITEMASK);
	const viewport = gl.getParameter(gl.VIEWPORT);
	const color = gl.getParameter(gl.COLOR_WRITEMASK);
	const alignment = gl.getParameter(gl.UNPACK_ALIGNMENT);
	const clip = gl.getExtension('EXT_clip_control');
	const clips = clip && [clip.CLIP_ORIGIN_EXT, clip.CLIP_DEPTH_MODE_EXT].map((name) => gl.getParameter(name));
	// depths as ecoview's: exact also far away
	clip?.clipControlEXT(clip.LOWER_LEFT_EXT, clip.ZERO_TO_ONE_EXT);
	const restore = () => {
		clip?.clipControlEXT(...clips);
		for (const [cap, on] of caps)
			(on ? gl.enable : gl.disable).call(gl, cap);
		gl.bindFramebuffer(gl.FRAMEBUFFER, framebuffer);
		gl.useProgram(program);
		gl.bindVertexArray(vertices);
		gl.activeTexture(unit);
		gl.depthFunc(func);
		gl.depthMask(mask);
		gl.viewport(...viewport);
		gl.colorMask(...color);
		gl.pixelStorei(gl.UNPACK_ALIGNMENT, alignment);
	};
	return { framebuffer, restore };
}

/** How a page blends, and how to put it back. */
function blendingOf(gl) {
	const read = (names) => names.map((name) => gl.getParameter(name));
	const equations = read([gl.BLEND_EQUATION_RGB, gl.BLEND_EQUATION_ALPHA]);
	const factors = read([gl.BLEND_SRC_RGB, gl.BLEND_DST_RGB, gl.BLEND_SRC_ALPHA, gl.BLEND_DST_ALPHA]);
	return () => {
		gl.blendEquationSeparate(...equations);
		gl.blendFuncSeparate(...factors);
	};
}

export class EcoLayer {
	/** vertices, bytes: budgets of a view (bytes -1: none); firstVertices, firstBytes: of a first picture, after
	 * which the rest comes (firstBytes Infinity: all comes at once); tint: 'none' or 'kind'; smooth: no leaves on
	 * ellipsoids; sky: draw one where nothing is; ground: draw it, else plants alone, which it still hides; scale: pixels drawn for each
	 * of the page's, either way; memoryBytes: of decoded data;
	 * sun: a time, in seconds since 1970, where it is then and there; null: where it usually is;
	 * shadows: 'none', 'standard' or 'perspective', by a map of shadowSize texels a side (0: 1024);
	 * haze: metres after which it hides all but 1/e (0: as usual);
	 * first: { about, view, wanted, body }, what a page has asked for before it had this module: a Scene, and
	 * the bytes of the answer to a first request, or a promise of them (null: there is none);
	 * keep: the browser keeps what comes until the next visit; token: of a scene that is not for all;
	 * onChange(): there is more to draw; onError(error): an EcoError, `offline` if the
	 * server does not answer and will be asked again. */
	constructor({ url, gl, vertices = 300000, bytes = -1, firstVertices = 80000, firstBytes = 65536,
		tint = 'none', smooth = false, sky = true, ground = true, scale = 1, memoryBytes, sun = null, shadows = 'none',
		shadowSize = 0, haze = 0, keep = false, token, first, onChange, onError }) {
		Object.assign(this, { gl, vertices, bytes, firstVertices, firstBytes, tint, smooth, sky, ground, scale, sun, shadows,
			shadowSize, haze, onChange, onError });
		this.asked = null;              // the view that is held or under way
		this.loading = false;
		this.offline = false;           // the server did not answer, and is asked again in a while
		this.version = 0;               // of what is drawn
		this.detail = '';               // set by who draws, for pictures that others are compared with: EcoStream.fetch
		this.arrived = false;           // all came of what was asked for last
		this.moving = false;            // set by who draws: shadows are those of the picture before
		this.hurried = false;           // set by who draws: moving pictures take too long, and lose their leaves
		this.leafy = false;             // leaves are drawn on ellipsoids
		this.samples = 16;              // that a picture at rest gets
		this.clip = [0, 1];             // shares of the width between which the picture is shown
		this.sampled = 0;               // samples of the picture that was drawn last
		this.most = SAMPLES_MAX;        // of them, as far as is known
		this.ahead = { asked: 0, aborted: 0 };   // requests that said where the eye will be
		this.source = { url, memoryBytes, keep, token };
		this.hidden = { names: '', of: null };   // layers that are not drawn, and the stream that knows
		this.hides = false;             // it is about to know
		this.ready = this.open(first);
	}

	/** Begins to load what all layers need. */
	static prepare() {
		compileClient().catch(() => {});         // who opens a layer is told
	}

	async open(first) {
		const { url, token } = this.source;
		if (!this.gl)
			throw new EcoError('There is no WebGL 2 context: this browser gives none');
		[, this.module, this.about] = await Promise.all([compileClient(), createClient({ instantiateWasm }),
			first?.about ?? aboutScene(url, token)]);
		this.context = this.module.GL.registerContext(this.gl,
			{ majorVersion: 2, minorVersion: 0, enableExtensionsByDefault: false });
		const stream = await this.openStream();
		// where it is of no use all is asked for as usual
		if (first?.body && !stream.held) {
			this.prepare(stream, first.wanted);
			await stream.take(first).then(() => stream.select(), () => {});
		}
		this.stream = stream;
	}

	/** Compiles what draws, while an answer is on its way. */
	prepare({ web }, { width, height }) {
		const { restore } = stateOf(this.gl);
		this.module.GL.makeContextCurrent(this.context);
		this.module._web_prepare(web, width, height);   // what fails will again where it is drawn
		restore();
	}

	/** Begins anew: the server has another pack of the scene. */
	async reopen() {
		const { url, token } = this.source, { id } = this.about;
		this.about = await aboutScene(url, token);
		if (this.about.id === id)
			throw new EcoError(`${url}: the server refuses the pack that it says it has`);
		const before = this.stream, stream = await this.openStream();
		if (!before)
			return stream.free();
		this.module.GL.makeContextCurrent(this.context);
		before.free();
		Object.assign(this, { stream, asked: null, drawn: null, hides: false });
	}

	/** A stream that holds what was kept of the last visit. */
	async openStream() {
		const { url, memoryBytes, token } = this.source, pack = this.about.id;
		const keep = this.source.keep ? await EcoKeep.open(pack) : null;
		const answers = keep ? await keep.answers() : [];
		const stream = new EcoStream(this.module, url, { memoryBytes, keep, pack, token });
		const { low, high } = this.about.bounds;
		if (await stream.replay(answers, { eye: high.map((v) => v + 1), target: low, fov_y_deg: 45 }))
			return stream;
		stream.free();
		await keep.clear();
		return new EcoStream(this.module, url, { memoryBytes, keep, pack, token });
	}

	/** The species that each plant of the pack stands for, and whether it is an object (EcoStream.species). */
	species() {
		const { stream } = this;
		if (this.named?.of !== stream)
			this.named = { of: stream, species: stream.species() };
		this.named.species.catch(() => { this.named = null; });
		return this.named.species;
	}

	/** From now on these are not drawn: some of 'plants' (also as points of summaries), 'objects', 'ground'. */
	async hide(names) {
		const { stream, module } = this, hides = (name) => names.includes(name) ? 1 : 0;
		if (!stream || this.hidden.names === String(names) && (this.hidden.of === stream || !names.length))
			return;
		this.hidden = { names: String(names), of: stream };
		this.hides = true;
		const plants = await this.species().catch(() => null) ?? [];
		if (stream !== this.stream || this.hidden.names !== String(names))
			return;
		plants.forEach(({ object }, i) => module._web_hide(stream.web, i, hides(object ? 'objects' : 'plants')));
		for (const [number, name] of [[SUMMARIES, 'plants'], [GROUND, 'ground']])
			module._web_hide(stream.web, number, hides(name));
		this.hides = false;
		stream.select();
		this.version++;
		this.onChange?.();
	}

	/** Highlights a plant, as one that is picked is, and says what it is, as pick() does; null: none, or it is not in view. */
	mark(plant) {
		return this.stream?.said('mark', plant?.list ?? -1, plant?.index ?? 0);
	}

	/** How far the picture that was compared last is from the one that was drawn last: { picture_error, m16 } (web_compare);
	 * null: there is none of its size. */
	compare() {
		return this.reading(() => this.stream.said('compare'));
	}

	/** Frees what the scene takes here and on the GPU. Nothing may be drawn afterwards. */
	free() {
		this.abort?.abort();
		this.module?.GL.makeContextCurrent(this.context);
		this.stream?.free();
		this.stream = null;
	}

	/** The eye of a perspective matrix, where clip.x, clip.y and clip.w are 0: for pages that know it no
	 * other way. */
	static eyeOf(m) {
		const rows = [0, 1, 3].map((i) => row(m, i)), [x, y, w] = rows;
		const sides = [cross(y, w), cross(w, x), cross(x, y)], det = dot(x, sides[0]);
		const last = [m[12], m[13], m[15]];
		return [0, 1, 2].map((k) => -dot(last, sides.map((side) => side[k])) / det);
	}

	/** Draws what is here of the view into the framebuffer that is bound; false: nothing is here yet, or the context
	 * is lost: then a new layer is needed. `next`: { eye, target } of where it will soon be, of a camera that moves. */
	draw(viewProjection, eye, [width, height], next = null) {
		if (!this.stream || this.gl.isContextLost())
			return false;
		const { view, depth } = cameraOf(viewProjection, eye);
		this.ask(view, width, height, next);
		return this.stream.selected && this.present(view, depth, width, height);
	}

	/** Whether the picture that was drawn last can have more samples: all of it is here. */
	get refines() {
		return this.complete && this.sampled < Math.min(this.samples, this.most);
	}

	/** Adds a sample of each pixel's colour to the picture that was drawn last, which the next draw() of the same
	 * view shows; false: it has all that it can have, or is not complete. A call draws about so many vertices of
	 * the sample, and the next calls draw the rest. */
	refine(vertices = Number.MAX_SAFE_INTEGER) {
		const { gl, module, stream } = this;
		return this.refines && !gl.isContextLost() && this.reading(() => {
			const restore = blendingOf(gl), failed = module._web_sample(stream.web, vertices);
			restore();
			this.sampled = failed ? this.sampled : module._web_samples(stream.web);
			this.most = failed ? this.sampled : SAMPLES_MAX;
			stream.check(failed > 0);
			return !failed;
		});
	}

	/** Whether a picture gets a shadow map of its own, and leaves: not while the camera moves, nor before all is here. */
	get resting() { return this.complete && !this.moving; }

	/** A picture's key: pictures of the same key look the same. */
	keyOf(view, width, height) {
		const size = [width, height].map((n) => Math.max(1, Math.round(n * this.scale)));
		this.leafy = !this.smooth && (this.resting || (this.leafy && !(this.moving && this.hurried)));
		return [view, size, this.tint, this.leafy, this.version, this.sun, this.shadows, this.shadowSize, this.haze,
			this.resting];
	}

	present(view, depth, width, height) {
		const { gl, module, stream } = this, state = stateOf(gl);
		const [x, y] = gl.getParameter(gl.VIEWPORT);
		module.GL.makeContextCurrent(this.context);
		try {
			const key = this.keyOf(view, width, height);
			if (!same(key, this.drawn)) {
				const at = stream.putView(view), origin = this.about.origin ?? {};
				module._web_sun(stream.web, origin.longitude_deg, origin.latitude_deg,
					origin.convergence_deg, this.sun ?? NaN);
				stream.check(module._web_sky(stream.web, SHADOWS[this.shadows], this.shadowSize,
					this.haze, this.resting ? 1 : 0));
				stream.check(module._web_draw(stream.web, at, ...key[1], TINTS[this.tint],
					this.leafy ? 0 : 1));
				[this.drawn, this.sampled, this.most] = [key, 1, SAMPLES_MAX];
			}
			gl.bindFramebuffer(gl.FRAMEBUFFER, state.framebuffer);
			module.HEAPF64.set([...depth, x, y, width, height], stream.view / 8);
			const [left, right] = this.clip.map((share) => Math.round(share * width));
			if (right - left < width) {
				gl.enable(gl.SCISSOR_TEST);
				gl.scissor(x + left, y, right - left, height);
			}
			const [depths, area] = [stream.view, stream.view + 16];
			module._web_present(stream.web, depths, area, this.sky ? 1 : 0, this.ground ? 1 : 0);
		} finally {
			state.restore();
		}
		return true;
	}

	/** Asks for a view unless it is here or on its way. An answer for a way that a camera no longer goes
	 * is given up. */
	ask(view, width, height, next = null) {
		const wanted = { view, width, height, vertices: this.vertices, bytes: this.bytes, detail: this.detail };
		const way = next && ['eye', 'target'].flatMap((key) => next[key].map((v, i) => v - view[key][i]));
		this.wanted = wanted;
		if (this.loading && this.way && !alike(way, this.way)) {
			this.ahead.aborted++;
			[this.way, this.asked] = [null, null];
			return this.abort.abort();
		}
		if (same(wanted, this.asked))
			return;
		if (!this.loading)
			this.load(wanted, next, way);
		else if (performance.now() - this.came > PATIENCE_MS)
			this.abort.abort();
	}

	async load(wanted, next = null, way = null) {
		this.loading = true;
		this.arrived = false;
		[this.asked, this.way] = [wanted, way];
		this.ahead.asked += !!next;
		[this.since, this.came] = [performance.now(), Infinity];
		this.abort = new AbortController();
		const show = () => {
			if (this.stream?.select())
				this.version++;
		};
		const onPart = () => {
			this.came = Math.min(this.came, performance.now());
			if (this.stream.selected && performance.now() - this.since < FIRST_MS)
				return;
			show();
			this.onChange?.();
		};
		try {
			const { signal } = this.abort;
			const most = wanted.bytes < 0 ? Infinity : wanted.bytes, bytes = Math.min(most, this.firstBytes);
			if (!this.stream.selected && bytes < most) {
				const vertices = Math.min(wanted.vertices, this.firstVertices);
				const first = this.stream.fetch(wanted.view, { ...wanted, signal, onPart, vertices, bytes });
				this.prepare(this.stream, wanted);
				await first;
				show();
				this.onChange?.();
			}
			this.arrived = await this.stream.fetch(wanted.view, { ...wanted, next, signal, onPart });
			show();
			this.offline = false;
		} catch (error) {
			if (error.status === 409)
				await this.reopen().catch((again) => this.onError?.(again));
			else if (isOffline(error))
				this.askLater();
			else if (error.name !== 'AbortError')
				this.onError?.(error);
		}
		this.loading = false;
		this.onChange?.();
	}

	askLater() {
		this.offline = true;
		this.onError?.(Object.assign(new EcoError('The server does not answer; trying again'),
			{ offline: true }));
		setTimeout(() => {
			this.asked = null;
			this.onChange?.();
		}, AGAIN_MS);
	}

	/** Whether all of the view that was drawn last is here. */
	get complete() {
		return !this.loading && !this.offline && !this.hides && same(this.wanted, this.asked);
	}

	facts() {
		return this.stream?.selected ? this.stream.facts() : null;
	}

	/** The result of `read`, with our context and the page's state put back: it reads what was drawn last from the
	 * GPU. */
	reading(read) {
		const state = stateOf(this.gl);
		this.module.GL.makeContextCurrent(this.context);
		try {
			return read();
		} finally {
			state.restore();
		}
	}

	/** `perPixel` bytes a pixel of the picture that was drawn last, by one of the client's functions. */
	pixels(read, perPixel) {
		const [width, height] = this.drawn[1], at = this.reading(() => read(this.stream.web));
		this.stream.check(!at);
		return this.module.HEAPU8.slice(at, at + perPixel * width * height);
	}

	/** The thing that is seen at a place of the picture that was drawn last (x and y in [0, 1], from the top left),
	 * or null without one: its `kind` is sky, ground, summary or plant (web_client.h). */
	pick(x, y) {
		if (!this.drawn)
			return null;
		const [width, height] = this.drawn[1];
		return this.reading(() => this.stream.pick(x * width, y * height));
	}

	/** 255 where a plant is, else 0: a byte a pixel of the picture that was drawn last, rows from the
	 * top. A copy, which is the caller's. */
	cover() {
		return this.pixels(this.module._web_cover, 1);
	}

	/** Its colours: 3 bytes a pixel, sRGB. */
	colors() {
		return this.pixels(this.module._web_colors, 3);
	}

	/** Whose each of its pixels is: 3 bytes of colour, a plant's own; black where there is none. */
	owners() {
		return this.pixels(this.module._web_owners, 3);
	}
}
