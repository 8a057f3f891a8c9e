export {
  GLTFDiffractionExporterPlugin,
  type GLTFDiffractionExporterOptions,
} from './exporter-plugin.ts'
export { EXTENSION } from './fields.ts'
export { GLTFDiffractionLoaderPlugin, type GLTFDiffractionLoaderOptions } from './loader-plugin.ts'
