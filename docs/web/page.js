// Starts a program in its page: shows how far it is loaded, tells what is missing, and notes when the first picture is there.

const loading = document.querySelector('#loading');
const bar = loading.querySelector('progress');

// Shows a message in place of the bar.
function fail(message) {
    bar.hidden = true;
    document.querySelector('#message').textContent = message;
}

// The file's bytes as they come, counted on the bar. A server that compresses tells no length that could be compared with them.
async function fetched(url, size) {
    const response = await fetch(url);
    if (!response.ok) {
        throw new Error(`${url}: ${response.status}`);
    }
    let loaded = 0;
    bar.max = size;
    const counted = new TransformStream({
        transform(part, controller) {
            loaded += part.byteLength;
            bar.value = loaded;
            controller.enqueue(part);
        },
    });
    return new Response(response.body.pipeThrough(counted), { headers: { 'content-type': 'application/wasm' } });
}

// Starts the program of this name, whose file has so many bytes.
export async function start(name, size) {
    const canvas = document.querySelector('#canvas');
    canvas.addEventListener('contextmenu', (event) => event.preventDefault());
    if (!document.createElement('canvas').getContext('webgl2')) {
        fail('This page needs WebGL2, which this browser does not have, or has turned off.');
        return;
    }
    new MutationObserver(() => {
        document.querySelector('#first-picture').textContent = (performance.now() / 1000).toFixed(1);
        canvas.focus();
    }).observe(document.documentElement, { attributeFilter: ['data-drawn'] });
    try {
        const { default: run } = await import(`./${name}.js`);
        await run({ module_or_path: fetched(`./${name}_bg.wasm`, size) });
    } catch (error) {
        // The window library leaves the program by an exception that is none.
        if (!String(error).includes('Using exceptions for control flow')) {
            fail(String(error));
            throw error;
        }
    }
}
