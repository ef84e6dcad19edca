// A scene's stream in JavaScript: asks the server, and hands what comes to the C client (web_client.h).
// Everything of a plan, a chunk or a picture is decided there; here are only bytes.

import { ask, leave } from './eco_ask.mjs';

const SLICE_BYTES = 65536;      // fed at a time, so that decoding leaves time for input
const SLICE_MS = 12;
const RETRY_MAX_MS = 30000;

const pause = (ms = 0) => new Promise((done) => setTimeout(done, ms));

/** A fault that a server or the client reports: `message` is for people, `status` HTTP's, if it is that. */
export class EcoError extends Error {}

const access = (token) => token ? { Authorization: `Bearer ${token}` } : {};

/** The error of an answer that is no stream: a problem document (RFC 9457), or a server that is none of
 * ours. */
async function problemOf(url, answer) {
	const type = answer.headers.get('content-type') ?? '';
	const document = type.includes('json') ? await answer.json().catch(() => null) : null;
	const detail = document?.title ? [document.title, document.detail].filter(Boolean).join(': ') : type;
	const error = new EcoError(`${url}: the server answered ${answer.status}: ${detail}`);
	return Object.assign(error, { status: answer.status });
}

/** The error of fetch where there is no answer, or it breaks off. */
export const isOffline = (error) => error instanceof TypeError;

/** A scene: openapi.yaml's Scene. */
export async function aboutScene(url, token) {
	const answer = await ask(url, '', { headers: access(token) }).catch((error) => {
		throw isOffline(error) ? new EcoError(`${url}: the server does not answer`) : error;
	});
	if (!answer.ok)
		throw await problemOf(url, answer);
	return answer.json();
}

/** One scene: what is held of it, and what is drawn. `module` is an instance of eco_client.mjs; `url` is
 * http://HOST/v1/scenes/NAME. */
export class EcoStream {
	/** keep: an EcoKeep, of what comes; pack: the id of the scene's pack, which is refused (409) once the
	 * server has another; token: of a scene that is not for all. */
	constructor(module, url, { memoryBytes = 512 * 2 ** 20, keep = null, pack, token } = {}) {
		Object.assign(this, { module, keep, pack, token });
		this.url = url.replace(/\/+$/, '');
		this.web = module._web_new(memoryBytes);
		if (!this.web)
			throw new EcoError('no memory for the scene');
		this.view = module._malloc(80);
		this.slice = module._malloc(SLICE_BYTES);
		this.selected = false;
		this.received = 0;              // bytes of answers of this visit
		this.held = false;              // whether something came of another
	}

	free() {
		leave(this.url, this.pack).catch(() => {});
		this.module._web_free(this.web);
		this.module._free(this.view);
		this.module._free(this.slice);
	}

	text(pointer) {
		return this.module.UTF8ToString(pointer);
	}

	check(failed) {
		if (failed)
			throw new EcoError(this.text(this.module._web_error(this.web)));
	}

	/** The view as the client reads it: eye, target, up (metres, Z up), fov_y_deg. */
	putView({ eye, target, up = [0, 0, 1], fov_y_deg }) {
		this.module.HEAPF64.set([...eye, ...target, ...up, fov_y_deg], this.view / 8);
		return this.view;
	}

	/** Streams one view. `onPart` is called after each slice that was decoded: a coarser picture may be
	 * there. Resolves to true, or false where no picture fits in `bytes`. `signal` ends it early: what
	 * came is kept. `next`: eye and target of a view that is wanted soon; what it lacks comes last. `detail`:
	 * 'all' is full detail, whatever the budgets; of 'all' and 'more' the browser keeps neither this nor what comes afterwards. */
	async fetch(view, { width, height, vertices, bytes = -1, next, detail, signal, onPart }) {
		const { module, web } = this;
		this.check(module._web_request(web, this.putView(view), width, height, vertices, bytes));
		if (detail === 'all')
			module._web_fully(web);
		this.keep = detail ? null : this.keep;
		if (next) {
			module.HEAPF64.set([...next.eye, ...next.target], this.view / 8);
			module._web_next(web, this.view);
		}
		for (let again = 1, first = true; again > 0; first = false) {
			const answer = await this.ask(signal);
			if (answer.status === 204)
				return false;
			await this.feed(answer.body.getReader(), onPart, !first);
			again = module._web_finish(web);
			this.check(again < 0);
		}
		return true;
	}

	/** Takes an answer, bytes or a promise of them, to a request that somebody else has made, of one who holds
	 * nothing. */
	async take({ view, wanted: { width, height, vertices, bytes: most }, body }) {
		const { module, web } = this;
		this.check(module._web_request(web, this.putView(view), width, height, vertices, most));
		this.check(!module._web_ask(web));
		const read = [{ value: new Uint8Array(await body) }, { done: true }];
		await this.feed({ read: () => read.shift() });
		this.check(module._web_finish(web) < 0);
	}

	/** Feeds what was kept of an earlier visit. False: it is not what this client understands; then the
	 * stream is of no more use. */
	async replay(answers, view) {
		const { module, web, keep } = this;
		const request = () => module._web_request(web, this.putView(view), 64, 64, 0, -1);
		this.keep = null;
		try {
			for (const { bytes, whole, again } of answers) {
				this.check((!again && request()) || !module._web_ask(web));
				const read = [{ value: bytes }, { done: true }];
				await this.feed({ read: () => read.shift() });
				this.check(whole && module._web_finish(web) < 0);
			}
		} catch {
			return false;
		}
		this.keep = keep;
		this.received = 0;
		this.held = answers.length > 0;
		return true;
	}

	query() {
		const query = this.text(this.module._web_query(this.web));
		return this.pack ? `${query}&pack=${this.pack}` : query;
	}

	/** One answer; a server that is busy is asked again when it says so. */
	async ask(signal) {
		const { module, web } = this;
		for (;;) {
			const body = module._web_ask(web);
			this.check(!body);
			const holdings = module.HEAPU8.slice(body, body + module._web_body_size(web));
			const headers = { 'Content-Type': 'application/octet-stream', ...access(this.token) };
			const answer = await ask(this.url, `/stream?${this.query()}`,
				{ method: 'POST', headers, body: holdings, signal });
			if (answer.ok)
				return answer;
			const retry = Number(answer.headers.get('retry-after')) * 1000;
			if (answer.status !== 503 || !(retry >= 0 && retry <= RETRY_MAX_MS))
				throw await problemOf(this.url, answer);
			await pause(Math.max(retry, 100));
		}
	}

	/** Decodes an answer as it comes, in slices; what came of one that breaks off is kept, too. */
	async feed(reader, onPart, again = false) {
		const parts = [];
		let since = performance.now(), whole = false;
		try {
			for (;;) {
				const { done, value } = await reader.read();
				if (done)
					break;
				parts.push(value);
				this.received += value.length;
				for (let at = 0; at < value.length; at += SLICE_BYTES) {
					this.feedSlice(value.subarray(at, at + SLICE_BYTES));
					if (performance.now() - since > SLICE_MS) {
						onPart?.();
						await pause();
						since = performance.now();
					}
				}
			}
			whole = true;
		} finally {
			this.keep?.add({ bytes: new Uint8Array(await new Blob(parts).arrayBuffer()), whole,
				again });
		}
	}

	feedSlice(part) {
		this.module.HEAPU8.set(part, this.slice);
		this.check(this.module._web_feed(this.web, this.slice, part.length));
	}

	/** From now on the plan that has come is drawn; false: none has. */
	select() {
		const before = this.module._web_select(this.web);
		this.check(before > 0);
		this.selected ||= before === 0;
		return before === 0;
	}

	/** The JSON that a function of the client returns. */
	said(name, ...values) {
		const text = this.module[`_web_${name}`](this.web, ...values);
		this.check(!text);
		return JSON.parse(this.text(text));
	}

	/** Figures of what is drawn: vertices, plants, predicted_q, predicted_m16, roles, models, bytes,
	 * memory_bytes and others. */
	facts() {
		return this.said('facts');
	}

	/** The thing that is seen at a pixel of the last picture: web_client.h. */
	pick(x, y) {
		return this.said('pick', x, y);
	}

	/** Height of the ground that is drawn at a place, or null. */
	ground(x, y) {
		const height = this.module._web_ground(this.web, x, y);
		return Number.isNaN(height) ? null : height;
	}

	/** The server's description of a plant that was picked: its species, and file, row and line of the inventory
	 * that it comes from, as far as it comes from one, and the plant that it is shown as (openapi.yaml's
	 * Plants). */
	async plant({ list, index }) {
		return (await this.rows(list, index, 1))[0];
	}

	/** The same of so many plants of a list, 1024 at most. */
	async rows(list, first, count) {
		const of = this.pack ? `&pack=${this.pack}` : '';
		const answer = await ask(this.url, `/plants/${list}?first=${first}&count=${count}${of}`,
			{ headers: access(this.token) });
		if (!answer.ok)
			throw await problemOf(this.url, answer);
		return (await answer.json()).plants;
	}

	/** Plants of all of the scene whose species, name in the pack or columns have a text, or whose row it is: openapi.yaml's
	 * Found, from place `first` on. */
	async find(text, first, count) {
		const of = this.pack ? `&pack=${this.pack}` : '';
		const answer = await ask(this.url, `/find?text=${encodeURIComponent(text)}&first=${first}&count=${count}${of}`, { headers: access(this.token) });
		if (!answer.ok)
			throw await problemOf(this.url, answer);
		return answer.json();
	}

	/** Plants in view, the nearest first (web_plants). */
	near(most) {
		return this.said('plants', most);
	}

	/** The species that each plant of the pack stands for, by its number (openapi.yaml's Species); null: the
	 * server has another pack by now. */
	async species() {
		const answer = await ask(this.url, '/species', { headers: access(this.token) });
		if (!answer.ok)
			throw await problemOf(this.url, answer);
		const { pack, plants } = await answer.json();
		return !this.pack || pack === this.pack ? plants : null;
	}

	/** A plan with its reasons (openapi.yaml's Plan), of the last request unless there is another query. */
	async plan(query = this.query()) {
		const answer = await ask(this.url, `/plan?${query}&explain=1`, { headers: access(this.token) });
		if (!answer.ok)
			throw await problemOf(this.url, answer);
		return answer.json();
	}

	/** Why each cut of the last request is what it is: rows of openapi.yaml's `explanation`. */
	async explain() {
		return (await this.plan()).explanation;
	}

	/** Vertices of all detail of the last request's view, as far as the server plans it. */
	async fullVertices() {
		const most = this.query().replace(/&bytes=\d+/, '').replace(/&vertices=\d+/, '&vertices=9223372036854775807');
		return (await this.plan(most)).vertices;
	}

	/** Says, as `ecoview --digest` does, what is held and drawn. */
	digest() {
		const text = this.module._web_digest(this.web);
		this.check(!text);
		return this.text(text);
	}
}
