// frame.mjs CHROMIUM RUNS URL...: what a frame costs in a browser, beside a page that only draws as many
// plain primitives of the same kinds. Of each scene's URL: the whole scene as the viewer frames it, 640 x 480
// from 300,000 vertices on. A plain frame is buffers made beforehand, one draw call a kind, a colour a
// primitive and a depth test: triangles; lines of a pixel; points for points, ellipsoids, summaries and
// impostors. Triangles and points are as large as cover together twice what the scene's plants cover. Frames
// of both alternate, each with a camera of its own, and each ends when a pixel was read. Prints medians and
// their ratio, and what our frames are made of where each part is waited for; and the processor time that a
// frame takes, of all the browser's threads, the least of some rounds: it is to be compared where others use
// the machine, too. That ratio counts. Beside it stands another, of the same page with points as large as
// each of ours: flat squares, where ours are ellipses. And what our frames take with shadows of both kinds, and how long a
// picture at rest of 800 x 600 takes to get 16 samples.
import { readdirSync, readFileSync } from 'node:fs';
import { Browser } from '../../client/web/browser.mjs';

const [chromium, runs, ...urls] = process.argv.slice(2);
const SIZE = [640, 480], REST = [800, 600], VERTICES = 300000, MOST = 1.5, ROUNDS = 4;

// ---- In the page ----

/** Sizes of all points that a frame draws, by transform feedback of a context of its own. */
function captureSizes(gl) {
	const [link, draw] = [gl.linkProgram.bind(gl), gl.drawArrays.bind(gl)], sizes = [];
	gl.linkProgram = (program) => {
		if (gl.getAttachedShaders(program).some((it) => gl.getShaderSource(it).includes('gl_PointSize')))
			gl.transformFeedbackVaryings(program, ['gl_PointSize'], gl.INTERLEAVED_ATTRIBS);
		link(program);
	};
	gl.drawArrays = (mode, first, count) => {
		if (mode !== gl.POINTS)
			return draw(mode, first, count);
		const buffer = gl.createBuffer(), held = new Float32Array(count);
		gl.bindBufferBase(gl.TRANSFORM_FEEDBACK_BUFFER, 0, buffer);
		gl.bufferData(gl.TRANSFORM_FEEDBACK_BUFFER, held.byteLength, gl.STREAM_READ);
		gl.beginTransformFeedback(mode);
		draw(mode, first, count);
		gl.endTransformFeedback();
		gl.getBufferSubData(gl.TRANSFORM_FEEDBACK_BUFFER, 0, held);
		gl.bindBufferBase(gl.TRANSFORM_FEEDBACK_BUFFER, 0, null);
		gl.deleteBuffer(buffer);
		held.forEach((size) => sizes.push(size));
	};
	return sizes;
}

async function openScene(url, [width, height], vertices, capture) {
	const { EcoLayer } = await import('/viewer/eco_layer.mjs');
	const { Camera } = await import('/viewer/viewer_camera.mjs');
	const gl = new OffscreenCanvas(width, height).getContext('webgl2', { antialias: false });
	const sizes = capture ? captureSizes(gl) : [];
	const layer = new EcoLayer({ url, gl, vertices, firstBytes: Infinity });
	await layer.ready;
	const camera = new Camera(), { bounds, near_m: near } = layer.about;
	camera.reach(bounds, near);
	camera.frame(bounds, width / height);
	globalThis.ours = { gl, layer, camera, size: [width, height] };
	ours.frame = (turn) => {
		camera.yaw += turn;
		const view = camera.view();
		layer.present({ ...view }, [0, 0], width, height);
		gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, new Uint8Array(4));
	};
	await layer.load({ view: camera.view(), width, height, vertices, bytes: -1 });
	layer.wanted = layer.asked;
	ours.frame(0);
	if (capture) {
		layer.free();
		globalThis.sizes = sizes;
		return Math.sqrt(sizes.reduce((sum, size) => sum + size * size, 0) / sizes.length);
	}
	const { roles, vertices: drawn } = layer.facts();
	return { drawn, roles: roles.filter((role) => role.vertices),
		covered: layer.cover().reduce((sum, c) => sum + (c > 0), 0) };
}

/** sized: its points are as large as ours. */
function openPlain([width, height], roles, covered, who, sized) {
	const gl = new OffscreenCanvas(width, height).getContext('webgl2', { antialias: false });
	const shader = (type, text) => {
		const it = gl.createShader(type);
		gl.shaderSource(it, `#version 300 es\nprecision highp float;\n${text}`);
		gl.compileShader(it);
		return it;
	};
	const program = gl.createProgram();
	gl.attachShader(program, shader(gl.VERTEX_SHADER, `layout(location = 0) in vec3 a_at;
		layout(location = 1) in vec4 a_color; uniform mat4 u_matrix; out vec4 v_color;
		${sized ? 'layout(location = 2) in' : 'uniform'} float u_size;
		void main() { gl_Position = u_matrix * vec4(a_at, 1); gl_PointSize = u_size; v_color = a_color; }`));
	gl.attachShader(program, shader(gl.FRAGMENT_SHADER, `in vec4 v_color; out vec4 o_color;
		void main() { o_color = v_color; }`));
	gl.linkProgram(program);
	gl.useProgram(program);
	gl.enable(gl.DEPTH_TEST);
	let seed = 1;
	const random = () => (seed = seed * 48271 % 2147483647) / 2147483647;
	const sum = (test) => roles.filter(({ name }) => test(name))
		.reduce((all, { vertices }) => all + vertices, 0);
	const counts = { triangles: Math.round(sum((name) => name.includes('triangles')) / 3),
		lines: Math.round(sum((name) => name.includes('lines')) / 2),
		points: sum((name) => !name.includes('triangles') && !name.includes('lines')) };
	const area = 2 * covered / (counts.triangles + counts.points), side = Math.sqrt(area);
	const kinds = [[gl.TRIANGLES, counts.triangles, 3, 1.7 * side], [gl.LINES, counts.lines, 2, 3 * side],
		[gl.POINTS, counts.points, 1, 0]].filter(([, count]) => count).map(([mode, count, corners, size]) => {
		const at = new Float32Array(count * corners * 3), color = new Uint8Array(count * corners * 4);
		for (let i = 0; i < count; i++) {
			const middle = [random() * 1.8 - 0.9, random() * 1.8 - 0.9, random() * 1.8 - 0.9];
			const shade = random() * 255;
			for (let k = 0; k < corners; k++) {
				const turn = 2 * Math.PI * (k / corners + shade), v = i * corners + k;
				at.set([middle[0] + Math.cos(turn) * size / width, middle[1] + Math.sin(turn) * size / height,
					middle[2]], 3 * v);
				color.set([shade, 255 - shade, 80, 255], 4 * v);
			}
		}
		const array = gl.createVertexArray();
		gl.bindVertexArray(array);
		[[at, 3, gl.FLOAT, false], [color, 4, gl.UNSIGNED_BYTE, true]].forEach(([data, n, type, unit], i) => {
			gl.bindBuffer(gl.ARRAY_BUFFER, gl.createBuffer());
			gl.bufferData(gl.ARRAY_BUFFER, data, gl.STATIC_DRAW);
			gl.enableVertexAttribArray(i);
			gl.vertexAttribPointer(i, n, type, unit, 0, 0);
		});
		if (sized && mode === gl.POINTS && sizes.length) {
			const size = Float32Array.from({ length: count }, (_, i) => sizes[i % sizes.length]);
			gl.bindBuffer(gl.ARRAY_BUFFER, gl.createBuffer());
			gl.bufferData(gl.ARRAY_BUFFER, size, gl.STATIC_DRAW);
			gl.enableVertexAttribArray(2);
			gl.vertexAttribPointer(2, 1, gl.FLOAT, false, 0, 0);
		}
		return { mode, array, count: count * corners };
	});
	if (!sized)
		gl.uniform1f(gl.getUniformLocation(program, 'u_size'), Math.max(1, side));
	const matrix = gl.getUniformLocation(program, 'u_matrix');
	let angle = 0;
	globalThis[who] = { frame(turn) {
		angle += turn;
		const [c, s] = [Math.cos(angle), Math.sin(angle)];
		gl.uniformMatrix4fv(matrix, false, [c, s, 0, 0, -s, c, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]);
		gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
		for (const { mode, array, count } of kinds) {
			gl.bindVertexArray(array);
			gl.drawArrays(mode, 0, count);
		}
		gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, new Uint8Array(4));
	} };
	return counts;
}

/** Frames of both in turns; then, of as many of ours, the parts: before each framebuffer that is bound waits
 * for what was drawn into the one before. Those are the records', light's and the page's. */
function timeFrames(runs) {
	const times = { ours: [], plain: [], sized: [], parts: { drawing: [], light: [], presenting: [] } };
	for (let i = 0; i < runs + 2; i++)
		for (const who of ['ours', 'plain', 'sized']) {
			const since = performance.now();
			globalThis[who].frame(1e-4);
			if (i >= 2)
				times[who].push(performance.now() - since);
		}
	const { gl } = ours, bind = gl.bindFramebuffer.bind(gl), marks = [];
	gl.bindFramebuffer = (...values) => {
		const whole = gl.getParameter(gl.IMPLEMENTATION_COLOR_READ_TYPE) === gl.UNSIGNED_INT;
		gl.readPixels(0, 0, 1, 1, whole ? gl.RGBA_INTEGER : gl.RGBA,
			whole ? gl.UNSIGNED_INT : gl.UNSIGNED_BYTE, whole ? new Uint32Array(4) : new Uint8Array(4));
		marks.push(performance.now());
		bind(...values);
	};
	for (let i = 0; i < runs; i++) {
		marks.length = 0;
		ours.frame(1e-4);
		const [since, ...ends] = marks;
		Object.values(times.parts).forEach((part, k) => part.push(ends[k] - (k ? ends[k - 1] : since)));
	}
	return times;
}

function drawFrames(who, count) {
	for (let i = 0; i < count; i++)
		globalThis[who].frame(1e-4);
}

/** Milliseconds a frame by the clock, the median of those after the first. */
function drawShaded(shadows, count) {
	ours.layer.shadows = shadows;
	ours.frame(1e-4);
	const times = Array.from({ length: count }, () => {
		const since = performance.now();
		ours.frame(1e-4);
		return performance.now() - since;
	});
	return times.sort((a, b) => a - b)[count >> 1];
}

/** Milliseconds until a new picture has all samples. */
function drawRest(shadows, [width, height]) {
	const { gl, layer, camera } = ours, since = performance.now();
	camera.yaw += 1e-4;
	Object.assign(layer, { shadows, wanted: layer.asked });
	do {
		layer.present({ ...camera.view() }, [0, 0], width, height);
		gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, new Uint8Array(4));
	} while (layer.refine());
	return performance.now() - since;
}

// ---- Here ----

/** The figure that `read` finds of a process or thread, or `otherwise` if that has ended. */
const ifThere = (read, otherwise) => {
	try {
		return read();
	} catch {
		return otherwise;
	}
};
const numbersIn = (folder) => ifThere(() => readdirSync(folder), []).filter((name) => /^\d+$/.test(name));
const wordsOf = (file) => ifThere(() => readFileSync(file, 'utf8'), '').replace(/.*\) /s, '').split(' ');

/** Milliseconds that all threads of a group of processes have run. */
function processorMs(group) {
	return numbersIn('/proc').filter((id) => wordsOf(`/proc/${id}/stat`)[2] === String(group))
		.flatMap((id) => numbersIn(`/proc/${id}/task`).map((thread) => `/proc/${id}/task/${thread}/schedstat`))
		.reduce((sum, file) => sum + Number(wordsOf(file)[0]) / 1e6, 0);
}

async function processorTimes(runs) {
	const least = { ours: Infinity, plain: Infinity, sized: Infinity };
	for (let i = 0; i < ROUNDS; i++)
		for (const who of Object.keys(least)) {
			const before = processorMs(browser.child.pid);
			await call(drawFrames, who, runs);
			least[who] = Math.min(least[who], (processorMs(browser.child.pid) - before) / runs);
		}
	return least;
}

/** With each kind of shadows, and after it none: processor time of frames, the least of some rounds. */
async function shadedTimes(runs) {
	const kinds = ['standard', 'perspective', 'none'], least = kinds.map(() => [Infinity, Infinity]);
	for (let i = 0; i < ROUNDS; i++)
		for (const [k, kind] of kinds.entries()) {
			await call(drawShaded, kind, 1);
			const before = processorMs(browser.child.pid), clock = await call(drawShaded, kind, runs);
			const spent = (processorMs(browser.child.pid) - before) / (runs + 1);
			least[k] = [Math.min(least[k][0], spent), Math.min(least[k][1], clock)];
		}
	return kinds.map((kind, k) => `${kind} ${least[k][0].toFixed(1)} ms (${least[k][1].toFixed(1)})`);
}

/** The least of some rounds, by the clock and of processor time. */
async function restTimes() {
	const kinds = ['none', 'standard', 'perspective'], least = kinds.map(() => [Infinity, Infinity]);
	for (let i = 0; i < ROUNDS; i++)
		for (const [k, kind] of kinds.entries()) {
			const before = processorMs(browser.child.pid), clock = await call(drawRest, kind, REST);
			least[k] = [clock, processorMs(browser.child.pid) - before].map((ms, j) => Math.min(ms, least[k][j]));
		}
	return kinds.map((kind, k) => `${kind} ${least[k][0].toFixed(0)} ms (${least[k][1].toFixed(0)})`);
}

const median = (list) => list.sort((a, b) => a - b)[list.length >> 1];
const browser = new Browser(chromium);
const call = (f, ...values) => browser.evaluate(`(${f})(...${JSON.stringify(values)})`);
let worst = 0;
try {
	await browser.open(new URL('/viewer/viewer.css', urls[0]).href, ...SIZE);
	await browser.evaluate(`globalThis.captureSizes = ${captureSizes}`);
	for (const url of urls) {
		const mean = await call(openScene, url, SIZE, VERTICES, true);
		const { drawn, roles, covered } = await call(openScene, url, SIZE, VERTICES, false);
		const counts = await call(openPlain, SIZE, roles, covered, 'plain', false);
		await call(openPlain, SIZE, roles, covered, 'sized', true);
		const spent = await processorTimes(Number(runs)), times = await call(timeFrames, Number(runs));
		const [ours, plain] = [median(times.ours), median(times.plain)], ratio = ours / plain;
		console.log(`${url.split('/').pop()}: ${drawn} vertices (${roles.map(({ name, vertices }) =>
			`${name} ${vertices}`).join(', ')}), ${covered} pixels of plants; plain: ${JSON.stringify(counts)}`);
		const parts = Object.entries(times.parts).map(([part, list]) => `${part} ${median(list).toFixed(1)}`);
		console.log(`  a frame takes ${ours.toFixed(1)} ms (${parts.join(', ')}), a plain one `
			+ `${plain.toFixed(1)} ms: ${ratio.toFixed(2)} x`);
		console.log(`  processor time ${spent.ours.toFixed(1)} ms, of a plain one ${spent.plain.toFixed(1)} ms: `
			+ `${(spent.ours / spent.plain).toFixed(2)} x`);
		const sized = median(times.sized);
		console.log(`  points as large as ours, ${mean?.toFixed(1) ?? '-'} pixels a side by their area, which does `
			+ `not count: ${sized.toFixed(1)} ms: ${(ours / sized).toFixed(2)} x; processor time `
			+ `${spent.sized.toFixed(1)} ms: ${(spent.ours / spent.sized).toFixed(2)} x`);
		console.log(`  processor time with shadows, and by the clock: ${(await shadedTimes(Number(runs))).join(', ')}`);
		console.log(`  16 samples at rest with shadows, and processor time: ${(await restTimes()).join(', ')}`);
		worst = Math.max(worst, ratio);
	}
	if (browser.complaints.length)
		console.log(browser.complaints.join('\n'));
} finally {
	await browser.close();
}
console.log(`the worst is ${worst.toFixed(2)} x; at most ${MOST} x is wanted`);
