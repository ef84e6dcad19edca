// A headless Chromium, driven over a pipe by its DevTools protocol: no package of npm is needed. Pages
// reach nothing but this machine.
import { spawn } from 'node:child_process';
import { mkdtempSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';

// Pages are drawn by Mesa, as ecoview's pictures are where there is no GPU: it snaps vertices to 1/256 of a
// pixel as GPUs do, while Chromium's own SwiftShader has 1/16.
const FLAGS = ['--headless', '--no-sandbox', '--remote-debugging-pipe', '--no-first-run', '--use-gl=angle',
	'--use-angle=gl-egl', '--ignore-gpu-blocklist', '--disable-quic', '--disable-sync',
	'--disable-background-networking', '--disable-component-update',
	'--host-resolver-rules=MAP * ~NOTFOUND , EXCLUDE 127.0.0.1'];
const ENVIRONMENT = { ...process.env, EGL_PLATFORM: 'surfaceless' };
const ANSWER_MS = 120000;

const described = (details) => details.exception?.description ?? details.text;
const pause = (ms) => new Promise((done) => setTimeout(done, ms));

export class Browser {
	constructor(program = 'chromium') {
		this.profile = mkdtempSync(join(tmpdir(), 'eco-browser-'));
		// a process group of its own, which ends as a whole
		this.child = spawn(program, [...FLAGS, `--user-data-dir=${this.profile}`], { env: ENVIRONMENT,
			stdio: ['ignore', 'ignore', 'ignore', 'pipe', 'pipe'], detached: true });
		this.number = 0;
		this.waiting = new Map();
		this.complaints = [];           // of pages: exceptions, errors on their consoles, files not there, preloads not used
		let rest = '';
		this.child.stdio[4].on('data', (bytes) => {
			const parts = (rest + bytes).split('\0');
			rest = parts.pop();
			parts.forEach((text) => this.hear(JSON.parse(text)));
		});
	}

	hear(message) {
		const { id, method, params } = message;
		if (method === 'Runtime.exceptionThrown')
			this.complaints.push(described(params.exceptionDetails));
		if (method === 'Runtime.consoleAPICalled' && params.type === 'error') {
			const texts = params.args.map((arg) => arg.value ?? arg.description);
			this.complaints.push(texts.join(' '));
		}
		if (method === 'Log.entryAdded'
				&& (params.entry.level === 'error' || params.entry.text.includes('preload')))
			this.complaints.push(`${params.entry.text} ${params.entry.url ?? ''}`);
		this.waiting.get(id)?.(message);
		this.waiting.delete(id);
	}

	send(method, params = {}) {
		const id = ++this.number;
		const message = JSON.stringify({ id, method, params, sessionId: this.session });
		this.child.stdio[3].write(`${message}\0`);
		return new Promise((done, fail) => {
			const late = () => fail(new Error(`the browser does not answer ${method}`));
			const timer = setTimeout(late, ANSWER_MS);
			this.waiting.set(id, ({ result, error }) => {
				clearTimeout(timer);
				if (error)
					fail(new Error(`${method}: ${error.message}`));
				else
					done(result);
			});
		});
	}

	/** Makes the page, the only one, before it is opened. */
	async attach() {
		const { targetId } = await this.send('Target.createTarget', { url: 'about:blank' });
		const { sessionId } = await this.send('Target.attachToTarget', { targetId, flatten: true });
		this.session = sessionId;
		await this.send('Page.enable');
		await this.send('Runtime.enable');
		await this.send('Log.enable');
	}

	/** Opens an address in a page of that size. */
	async open(url, width, height, { mobile = false, dark = false } = {}) {
		if (!this.session)
			await this.attach();
		await this.send('Emulation.setDeviceMetricsOverride',
			{ width, height, deviceScaleFactor: 1, mobile });
		await this.send('Emulation.setEmulatedMedia',
			{ features: [{ name: 'prefers-color-scheme', value: dark ? 'dark' : 'light' }] });
		await this.send('Page.navigate', { url: 'about:blank' });
		await this.send('Page.navigate', { url });
	}

	/** The value of an expression in the page; promises are waited for. */
	async evaluate(expression) {
		const { result, exceptionDetails } = await this.send('Runtime.evaluate',
			{ expression, awaitPromise: true, returnByValue: true });
		if (exceptionDetails)
			throw new Error(described(exceptionDetails));
		return result.value;
	}

	async until(expression, ms = 300000) {
		for (const end = Date.now() + ms; Date.now() < end; await pause(50))
			if (await this.evaluate(expression).catch(() => false))
				return;
		const said = this.complaints.join('; ');
		throw new Error(`not within ${ms} ms: ${expression}; the page says: ${said}`);
	}

	/** A PNG of the page, or of a part of it: { x, y, width, height, scale }. */
	async picture(clip) {
		const { data } = await this.send('Page.captureScreenshot', { format: 'png', clip });
		return Buffer.from(data, 'base64');
	}

	async close() {
		const ended = new Promise((done) => this.child.once('exit', done));
		process.kill(-this.child.pid, 'SIGKILL');
		await ended;
		rmSync(this.profile, { recursive: true, force: true, maxRetries: 20, retryDelay: 100 });
	}
}
