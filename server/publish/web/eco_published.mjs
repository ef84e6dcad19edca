// Answers for a scene of a published folder: its files, and streams and plans by a worker, a worker for each pack.
//
// To eco_planner_worker.mjs: { id, folder, path, body }, a request; { id, abort: true }. From it: { id, part }, the next
// bytes of the answer; { id, status, error }, its end; { id, name, failed }: there is none.

const hosts = new Map();         // by folder: { worker, running: Map of listeners by id, left }
let last = 0;

function hostOf(folder) {
	let host = hosts.get(folder);
	if (!host) {
		const worker = new Worker(new URL('eco_planner_worker.mjs', import.meta.url), { type: 'module' });
		host = { worker, running: new Map() };
		worker.onmessage = ({ data }) => host.running.get(data.id)?.(data);
		worker.onerror = ({ message }) => {
			hosts.delete(folder);
			for (const listener of host.running.values())
				listener({ failed: message ?? 'the planner could not be loaded', name: 'TypeError' });
		};
		hosts.set(folder, host);
	}
	return host;
}

/** A worker that nobody needs ends, with the memory that its scene takes, once it has answered all. */
function end(folder, host) {
	if (!host.left || host.running.size || hosts.get(folder) !== host)
		return;
	host.worker.terminate();
	hosts.delete(folder);
}

const folderOf = (url, pack) => new URL(`${url}/${pack}/`, import.meta.url).href;

export function leave(url, pack) {
	const folder = folderOf(url, pack), host = hosts.get(folder);
	if (host) {
		host.left = true;
		end(folder, host);
	}
}

function problem(status, title) {
	const headers = { 'Content-Type': 'application/problem+json' };
	return new Response(JSON.stringify({ status, title }), { status, headers });
}

/** A Response, as fetch of ecoserve's would bring it. */
function planned(folder, path, body, signal) {
	const host = hostOf(folder), { worker, running } = host, id = ++last;
	host.left = false;
	return new Promise((resolve, reject) => {
		let control = null;
		const stop = () => worker.postMessage({ id, abort: true });
		const cancel = () => {
			running.delete(id);
			stop();
			end(folder, host);
		};
		const stream = new ReadableStream({ start: (given) => { control = given; }, cancel });
		const response = new Response(stream);
		const close = (why) => {
			running.delete(id);
			end(folder, host);
			signal?.removeEventListener('abort', stop);
			if (why) {
				reject(why);
				control.error(why);
			} else {
				control.close();
			}
		};
		signal?.addEventListener('abort', stop);
		running.set(id, ({ part, status, error, failed, name }) => {
			if (part) {
				control.enqueue(part);
				return resolve(response);
			}
			if (failed !== undefined)
				return close(signal?.aborted ? signal.reason : Object.assign(name === 'TypeError' ? new TypeError(failed)
					: new Error(failed), { name }));
			resolve(status >= 400 ? problem(status, error) : new Response(null, { status: 204 }));
			close();
		});
		worker.postMessage({ id, folder, path, body });
	});
}

/** The answer to `path` of a scene: ecoserve's routes below /v1/scenes/NAME. */
export async function answer(url, path, { body, signal } = {}) {
	const [route, query = ''] = path.split('?');
	if (route === '' || route === '/species')
		return fetch(`${url}${route || '/scene'}.json`, { signal, cache: 'no-cache' });
	const pack = new URLSearchParams(query).get('pack') ?? (await (await fetch(`${url}/scene.json`)).json()).id;
	signal?.throwIfAborted();
	return planned(folderOf(url, pack), path, body, signal);
}
