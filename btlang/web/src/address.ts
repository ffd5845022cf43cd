// Addresses of screens.
/** The address of a screen: #/robots/kim/tasks */
export const address = (...parts: string[]): string => `#/${parts.map(encodeURIComponent).join("/")}`;
