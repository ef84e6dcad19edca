// The server of a published scene (ecopack publish), in a worker of the page: it answers what EcoStream asks of
// ecoserve, by the same code (planner.h), from the scene's index and from parts of its chunks' file. Messages to it
// and from it: eco_published.mjs.
import createPlanner from './eco_planner.mjs';

const GAP_BYTES = 1024;          // chunks that lie less than this apart are fetched together
const FETCHES_MAX = 32;          // at a time, where the browser allows
const PART_BYTES = 65536;        // that are sent before the rest of a body is there

/** Ranges that hold the wanted chunks, in their order: { at, end, chunks: [[at, size, to]], last: chunks so far }. */
export function rangesOf(wanted) {
	const ranges = [];
	wanted.forEach(([at, size, to], i) => {
		const range = ranges.at(-1);
		if (range && at >= range.at && at <= range.end + GAP_BYTES) {
			range.end = Math.max(range.end, at + size);
			range.chunks.push([at, size, to]);
			range.last = i + 1;
		} else {
			ranges.push({ at, end: at + size, chunks: [[at, size, to]], last: i + 1 });
		}
	});
	return ranges;
}

/** A file on a static host, of which parts are read; as a whole where the host ignores Range, which a request for one
 * byte tells before any other. */
export class RangeFile {
	constructor(url) {
		Object.assign(this, { url, probed: null });
	}

	/** All of it, or null where the host knows Range; asked for anew after a failure. */
	probe() {
		this.probed ??= this.ask(0, 1).then(async (answer) => answer.status === 206 ? null
			: new Uint8Array(await answer.arrayBuffer()));
		this.probed.catch(() => { this.probed = null; });
		return this.probed;
	}

	/** A query that hosts of files ignore gives each part a name of its own: browsers fetch one name once at a time. */
	async ask(at, end, signal) {
		const range = `bytes=${at}-${end - 1}`;
		const answer = await fetch(`${this.url}?${range}`, { signal, headers: { Range: range } });
		if (!answer.ok)
			throw refused(this.url, answer);
		return answer;
	}

	async read(at, end, signal) {
		const whole = await this.probe(), answer = whole ? null : await this.ask(at, end, signal);
		const came = whole ?? new Uint8Array(await answer.arrayBuffer());
		// some caches ignore Range now and then
		const bytes = answer?.status === 206 ? came : came.subarray(at, end);
		if (bytes.length !== end - at)
			throw new Error(`${this.url}: ${bytes.length} bytes instead of ${end - at}`);
		return bytes;
	}
}

function refused(url, { status }) {
	return Object.assign(new Error(`${url}: the server answered ${status}`), { status });
}

export class Planner {
	/** folder: the URL of a scene's files, which ends with '/'; module: what createPlanner is given. */
	static async open(folder, module = {}) {
		const planner = new Planner(), file = new RangeFile(new URL('chunks.bin', folder));
		file.probe();
		const [answer, m] = await Promise.all([fetch(new URL('index.bin', folder)), createPlanner(module)]);
		if (!answer.ok)
			throw refused(folder, answer);
		const bytes = new Uint8Array(await answer.arrayBuffer());
		Object.assign(planner, { m, file, turn: null });
		if (m._planner_open(planner.put(bytes), bytes.length) !== 200)
			throw new Error(planner.error());
		return planner;
	}

	/** A copy of these bytes that C reads. */
	put(...parts) {
		let at = this.m._malloc(parts.reduce((sum, { length }) => sum + length, 0));
		if (!at)
			throw new Error('no memory for the planner');
		const first = at;
		for (const part of parts) {
			this.m.HEAPU8.set(part, at);
			at += part.length;
		}
		return first;
	}

	error() {
		return this.m.UTF8ToString(this.m._planner_error());
	}

	wanted() {
		const { m } = this, at = m._planner_wanted() / 8, count = m._planner_wanted_count();
		return Array.from({ length: count }, (_, i) => [...m.HEAPF64.subarray(at + 3 * i, at + 3 * i + 3)]);
	}

	/** Fetches wanted chunks to where they belong; onPart(n): the first n are there, PART_BYTES and more since last. */
	async fetch(wanted, signal, onPart) {
		const ranges = rangesOf(wanted), parts = [];
		let came = 0;
		for (let i = 0; i < ranges.length; i++) {
			for (let k = parts.length; k < Math.min(ranges.length, i + FETCHES_MAX); k++) {
				parts[k] = this.file.read(ranges[k].at, ranges[k].end, signal);
				parts[k].catch(() => {});
			}
			const bytes = await parts[i], { at: from, chunks, last } = ranges[i];
			parts[i] = null;
			for (const [at, size, to] of chunks)
				this.m.HEAPU8.set(bytes.subarray(at - from, at - from + size), to);
			came += bytes.length;
			if (came >= PART_BYTES || last === wanted.length) {
				onPart?.(last);
				came = 0;
			}
		}
	}

	/** One request at a time: path is that of ecoserve's routes with its query, as '/stream?eye=...'; holdings: the
	 * body, or none; onPart(bytes): the next ones of the answer. Resolves to { status, error }. */
	async answer(path, holdings, onPart, signal) {
		const before = this.turn;
		let done;
		this.turn = new Promise((resolve) => { done = resolve; });
		await before;
		try {
			signal?.throwIfAborted();
			const status = await this.plan(path, holdings ?? new Uint8Array(4), onPart, signal);
			return { status, error: status >= 400 ? this.error() : null };
		} finally {
			done();
		}
	}

	/** openapi.yaml's Plants and Found, of published rows. */
	async plants(path, onPart, signal) {
		const { m } = this, text = new TextEncoder().encode(`/v1/scenes/x${path}\0`), at = this.put(text);
		try {
			let status = 100;
			for (let again = 0; status === 100; again = 1) {
				if (again)
					await this.fetch(this.wanted(), signal);
				status = m._planner_plants(at, again);
			}
			if (status === 200)
				onPart(new TextEncoder().encode(m.UTF8ToString(m._planner_body())));
			return status;
		} finally {
			m._free(at);
		}
	}

	ask(path, holdings) {
		const { m } = this, text = new TextEncoder().encode(`${path}\0`), at = this.put(text, holdings);
		const status = m._planner_ask(at, at + text.length, holdings.length);
		m._free(at);
		return status;
	}

	async plan(path, holdings, onPart, signal) {
		const { m } = this;
		if (/^\/(plants|find)\b/.test(path))
			return this.plants(path, onPart, signal);
		let status = this.ask(path, holdings);
		this.rounds = 0;
		while (status === 200 && (status = m._planner_go()) === 100) {
			this.rounds++;
			await this.fetch(this.wanted(), signal);
			status = 200;
		}
		if (status !== 200)
			return status;
		if (path.startsWith('/plan')) {
			onPart(new TextEncoder().encode(m.UTF8ToString(m._planner_described())));
			return status;
		}
		let sent = 0;
		const wanted = this.wanted(), send = (count) => {
			const final = m._planner_part(count), at = m._planner_body();
			if (final < 0)
				throw new Error(this.error());
			if (final > sent)
				onPart(m.HEAPU8.slice(at + sent, at + final));
			sent = Math.max(sent, final);
		};
		await this.fetch(wanted, signal, send);
		if (!wanted.length)
			send(0);
		return status;
	}
}

if (globalThis.WorkerGlobalScope) {
	let opened = null;
	const running = new Map();
	globalThis.onmessage = async ({ data: { id, folder, path, body, abort } }) => {
		if (abort)
			return running.get(id)?.abort();
		opened ??= Planner.open(folder);
		const control = new AbortController();
		running.set(id, control);
		try {
			const planner = await opened;
			const onPart = (part) => postMessage({ id, part }, [part.buffer]);
			postMessage({ id, ...await planner.answer(path, body, onPart, control.signal) });
		} catch (error) {
			opened?.catch(() => { opened = null; });
			if (error instanceof WebAssembly.RuntimeError)
				opened = null;           // out of memory: this module answers nothing more
			// gone: another pack was published since
			postMessage(error.status === 404 ? { id, status: 409, error: error.message }
				: { id, failed: error.message, name: error.name });
		}
		running.delete(id);
	};
}
