// The picture of the tree of the mission that is edited, which follows the text.
import { randomBytes } from "node:crypto";
import { Disposable, Uri, ViewColumn, WebviewPanel, window, workspace } from "vscode";
import { LSPErrorCodes, ResponseError } from "vscode-languageclient/node";

const ENDING = ".test.txt";

export function isTest(uri: Uri): boolean {
  return uri.path.endsWith(ENDING);
}

export interface Drawing {
  svg: string;
  is_whole: boolean;
}

const REST = 150; // milliseconds without a key until the tree is drawn

/** The panel beside the editor. `draw` asks the server; it gives undefined while there is none. */
export class TreeView implements Disposable {
  private panel: WebviewPanel | undefined;
  private uri: Uri | undefined;
  private timer: NodeJS.Timeout | undefined;
  private readonly listeners: Disposable;

  constructor(private readonly draw: (uri: Uri) => Promise<Drawing | undefined>) {
    this.listeners = Disposable.from(
      workspace.onDidChangeTextDocument(({ document }) => document.uri.toString() === this.uri?.toString() && this.redraw(REST)),
      window.onDidChangeActiveTextEditor((editor) => {
        if (this.panel && editor?.document.languageId === "btlang" && !isTest(editor.document.uri)) this.follow(editor.document.uri);
      }),
    );
  }

  show(uri: Uri | undefined): void {
    if (!uri) return;
    if (!this.panel) {
      this.panel = window.createWebviewPanel("btlang.tree", "Tree", { viewColumn: ViewColumn.Beside, preserveFocus: true }, { enableScripts: true, localResourceRoots: [] });
      this.panel.webview.html = page();
      this.panel.webview.onDidReceiveMessage(() => this.redraw(0)); // it's ready, also after it was hidden
      this.panel.onDidDispose(() => (this.panel = undefined));
    } else {
      this.panel.reveal(undefined, true);
    }
    this.follow(uri);
  }

  /** Draws the tree again: the server is another one. */
  refresh(): void {
    this.redraw(0);
  }

  dispose(): void {
    clearTimeout(this.timer);
    this.listeners.dispose();
    this.panel?.dispose();
  }

  private follow(uri: Uri): void {
    this.uri = uri;
    if (this.panel) this.panel.title = `Tree of ${uri.path.split("/").pop()}`;
    this.redraw(0);
  }

  private redraw(delay: number): void {
    clearTimeout(this.timer);
    this.timer = setTimeout(async () => {
      const uri = this.uri;
      if (!this.panel || !uri) return;
      try {
        const drawing = await this.draw(uri);
        if (drawing && uri === this.uri) await this.panel?.webview.postMessage(drawing);
      } catch (error) {
        if (error instanceof ResponseError && error.code === LSPErrorCodes.ContentModified) this.redraw(2 * REST);
      }
    }, delay);
  }
}

/** The page shows pictures that it's sent. Its policy lets nothing else in: the texts in a picture are data. */
function page(): string {
  const nonce = randomBytes(16).toString("hex");
  return `<!doctype html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta http-equiv="Content-Security-Policy" content="default-src 'none'; style-src 'unsafe-inline'; script-src 'nonce-${nonce}'">
<title>Tree</title>
<style>
body { margin: 0; padding: 8px; }
#said { min-height: 1.4em; }
#tree svg { display: block; border-radius: 4px; }
#tree.fit svg { max-width: 100%; height: auto; }
#tree.old { opacity: 0.5; }
label { float: right; }
</style>
</head>
<body>
<div><label><input type="checkbox" id="fit" checked> Fit the width</label><div id="said" role="status">Waiting for the language server</div></div>
<div id="tree" class="fit"></div>
<script nonce="${nonce}">
const vscode = acquireVsCodeApi();
const tree = document.getElementById("tree"), said = document.getElementById("said"), fit = document.getElementById("fit");
fit.addEventListener("change", () => tree.classList.toggle("fit", fit.checked));
addEventListener("message", ({ data }) => {
  tree.classList.toggle("old", !data.svg);
  if (data.svg) tree.innerHTML = data.svg;
  said.textContent = data.is_whole ? "" : data.svg ? "Without the parts that aren't understood" : "The text isn't understood yet";
});
vscode.postMessage("ready");
</script>
</body>
</html>`;
}
