// mcap_core.mjs BAG.mcap: reads a bag with Foxglove's own reader, by its index and again from its beginning, and prints
// each topic with its type and number of messages. NODE_PATH must lead to @mcap/core.
import { createRequire } from 'node:module';
import { open, readFile } from 'node:fs/promises';

const require = createRequire(process.env.NODE_PATH + '/');
const { McapIndexedReader, McapStreamReader } = require('@mcap/core');

const file = await open(process.argv[2]);
const readable = {
    size: async () => BigInt((await file.stat()).size),
    read: async (offset, size) => {
        const bytes = new Uint8Array(Number(size));
        await file.read(bytes, 0, Number(size), Number(offset));
        return bytes;
    },
};
const reader = await McapIndexedReader.Initialize({ readable });
const count = new Map();
for await (const message of reader.readMessages()) {
    count.set(message.channelId, (count.get(message.channelId) ?? 0) + 1);
}
const stream = new McapStreamReader();
stream.append(await readFile(process.argv[2]));
let streamed = 0;
for (let record; (record = stream.nextRecord());) {
    streamed += record.type === 'Message' ? 1 : 0;
}
for (const [id, channel] of reader.channelsById) {
    const schema = reader.schemasById.get(channel.schemaId);
    console.log(channel.topic, schema.name, schema.encoding, channel.messageEncoding, count.get(id) ?? 0);
}
console.log('messages', Number(reader.statistics.messageCount), streamed);
await file.close();
