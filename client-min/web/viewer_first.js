// Begins what takes longest before anything else has come: the worker, with what it loads, and the requests
// for what a link shows: its scene, and a first answer of EcoLayer's first budgets, unless the browser keeps
// what came of the last visit. viewer.mjs takes them from here. No module, as those wait for the page.
{
	const published = JSON.parse(document.getElementById('published')?.textContent ?? 'null');     // eco_ask.mjs
	const given = new URLSearchParams(location.hash.slice(1)), scene = given.get('scene') ?? published?.[0].about.name;
	const ratio = Math.min(devicePixelRatio, 2), bytes = Number(given.get('bytes') ?? -1);
	const [width, height] = [innerWidth, innerHeight].map((n) => Math.max(1, Math.round(n * ratio)));
	const [eye, target] = ['eye', 'target'].map((key) => given.get(key)?.split(',').map(Number));
	const url = `v1/scenes/${encodeURIComponent(scene)}`, vertices = Number(given.get('vertices')) || 300000;
	const wanted = { width, height, vertices: Math.min(vertices, 80000),
		bytes: Math.min(bytes < 0 ? Infinity : bytes, 65536) };
	const query = `eye=${eye}&target=${target}&fov_y_deg=45&${new URLSearchParams(wanted)}`;
	const kept = (() => { try { return localStorage.getItem(`kept ${scene}`); } catch { return null; } })();
	const { src } = document.currentScript;
	// a preload is the page's alone: once read, the worker finds it in the browser's cache
	fetch(new URL('eco_client.wasm', src)).then((client) => client.arrayBuffer()).catch(() => {});
	if (HTMLCanvasElement.prototype.transferControlToOffscreen) {
		globalThis.engine = new Worker(new URL('viewer_engine.mjs', src), { type: 'module' });
		engine.onerror = () => { engine.failed = true; };
	}
	const own = published?.find(({ about }) => about.name === scene);
	if (own) {
		// the first view, unless the link has another one that was saved
		const near = (a, b) => a.every((v, i) => Math.abs(v - b[i]) < 2e-3);
		const saved = (view) => near(view.eye, eye) && near(view.target, target);
		const number = eye && target ? own.first.findIndex(saved) : 0, { eye: from, target: to, ...size } = own.first[number] ?? {};
		const answer = from && kept !== own.about.id ? fetch(`${scene}/${own.about.id}/first-${number}.bin`)
			.then((came) => new Response(came.body, { status: came.status })) : null;
		// all that the planner's worker loads comes at once, for the browser's cache, but after a first picture
		Promise.resolve(answer).then((came) => came?.clone().arrayBuffer()).catch(() => {}).then(() => {
			for (const file of [...['eco_published.mjs', 'eco_planner_worker.mjs', 'eco_planner.mjs', 'eco_planner.wasm']
				.map((name) => new URL(name, src)), `${scene}/${own.about.id}/index.bin`])
				fetch(file).then((came) => came.arrayBuffer()).catch(() => {});
		});
		globalThis.first = { scene, about: Promise.resolve(Response.json(own.about)), answer, wanted: size,
			view: { eye: from, target: to, up: [0, 0, 1], fov_y_deg: 45 } };
	} else if (scene && !published && !given.has('token')) {
		const numbers = [eye, target, vertices, bytes].flat();
		const answer = numbers.every(Number.isFinite) && !kept ? fetch(`${url}/stream?${query}`) : null;
		globalThis.first = { scene, about: fetch(url), answer, wanted,
			view: { eye, target, up: [0, 0, 1], fov_y_deg: 45 } };
		[first.about, answer].forEach((asked) => asked?.catch(() => {}));
	}
}
