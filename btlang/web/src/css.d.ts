// Style sheets that are loaded with a screen are imported as texts.
declare module "*.css" {
  const text: string;
  export default text;
}
