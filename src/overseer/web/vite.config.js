import { defineConfig } from "vite";

// During development the page comes from Vite and everything else from an overseer (or the mock) beside it.
const overseer = process.env.AURASIM_URL ?? "http://127.0.0.1:8080";

export default defineConfig({
  server: {
    host: "127.0.0.1",
    proxy: { "/ws": { target: overseer, ws: true }, "/api": overseer },
  },
});
