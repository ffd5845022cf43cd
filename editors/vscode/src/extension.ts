// The client of `btc lsp`, the commands of its code lenses, and the picture of the tree beside the text.
import { dirname } from "node:path";
import { commands, ExtensionContext, ProcessExecution, Task, TaskPanelKind, tasks, TaskScope, Uri, window, workspace } from "vscode";
import { LanguageClient, RevealOutputChannelOn, State } from "vscode-languageclient/node";
import { isTest, TreeView } from "./tree_view";

let client: LanguageClient | undefined;
let tree: TreeView | undefined;

export async function activate(context: ExtensionContext): Promise<void> {
  tree = new TreeView(async (uri) => (client?.state === State.Running ? client.sendRequest("btlang.drawTree", { textDocument: { uri: uri.toString() } }) : undefined));
  context.subscriptions.push(
    tree,
    commands.registerCommand("btlang.run", (uri) => start(target(uri), "run", ["run", ...setting<string[]>("options", [])])),
    commands.registerCommand("btlang.test", (uri, name) => start(target(uri), "test", ["test", ...(name ? ["--name", name] : [])])),
    commands.registerCommand("btlang.tree", (uri) => tree?.show(target(uri))),
    commands.registerCommand("btlang.restart", connect),
    workspace.onDidChangeConfiguration((change) => change.affectsConfiguration("btlang") && connect()),
  );
  await connect();
}

export async function deactivate(): Promise<void> {
  await client?.dispose();
}

function setting<T>(name: string, fallback: T): T {
  return workspace.getConfiguration("btlang").get<T>(name) ?? fallback;
}

/** The file that a code lens or a button names, or that of the editor. */
function target(uri: string | Uri | undefined): Uri | undefined {
  return typeof uri === "string" ? Uri.parse(uri) : (uri ?? window.activeTextEditor?.document.uri);
}

/** Starts the server, or starts it again with other settings. */
async function connect(): Promise<void> {
  await client?.dispose().catch(() => undefined);
  const command = setting("command", "btc");
  const folder = workspace.workspaceFolders?.[0]?.uri.fsPath;
  const files = setting<string[]>("otherFiles", []).map((pattern) => ({ scheme: "file", pattern }));
  client = new Client(
    "btlang",
    { command, args: ["lsp", ...setting<string[]>("options", [])], ...(folder ? { options: { cwd: folder } } : {}) },
    {
      documentSelector: [{ language: "btlang" }, ...files],
      revealOutputChannelOn: RevealOutputChannelOn.Never,
    },
  );
  try {
    await client.start();
    tree?.refresh();
  } catch {
    void offerHelp(command, client);
  }
}

async function offerHelp(command: string, { outputChannel }: LanguageClient): Promise<void> {
  const help = "Install it with pip install 'btlang[lsp]', or set btlang.command to its path.";
  const chosen = await window.showErrorMessage(`'${command} lsp' can't be started. ${help}`, "Open Settings", "Show Output");
  if (chosen === "Open Settings") await commands.executeCommand("workbench.action.openSettings", "btlang.command");
  if (chosen === "Show Output") outputChannel.show();
}

/** A client that only writes to its output why it can't start: `offerHelp` says what to do about it. */
class Client extends LanguageClient {
  override error(message: string, data?: unknown, show: boolean | "force" = true): void {
    super.error(message, data, this.state === State.Starting || this.state === State.StartFailed ? false : show);
  }
}

/** Saves a file and runs a verb of `btc` on it in a terminal, without a shell that would read its name. */
async function start(uri: Uri | undefined, verb: "run" | "test", words: string[]): Promise<void> {
  if (!uri) return;
  if (uri.scheme !== "file") {
    void window.showInformationMessage("Save the mission first: btc runs files.");
    return;
  }
  const open = workspace.textDocuments.find((each) => each.uri.toString() === uri.toString());
  if (open?.isDirty && !(await open.save())) return;
  const folder = workspace.getWorkspaceFolder(uri);
  const file = verb === "test" && !isTest(uri) ? dirname(uri.fsPath) : uri.fsPath;
  const run = new ProcessExecution(setting("command", "btc"), [...words, file], { cwd: folder?.uri.fsPath ?? dirname(uri.fsPath) });
  const task = new Task({ type: "btlang", verb }, folder ?? TaskScope.Workspace, verb, "btlang", run, []);
  task.presentationOptions = { panel: TaskPanelKind.Dedicated, clear: true, showReuseMessage: false };
  await tasks.executeTask(task);
}
