"""A publisher under another node's name. Any process that reaches the nodes can do this: ROS 1 does not authenticate clients."""

import io
import socket
import struct
import threading
import xmlrpc.client
import xmlrpc.server

import rosgraph

import live_platoon


def packed(fields):
    lines = b"".join(struct.pack("<I", len(line)) + line for line in ("{}={}".format(*field).encode() for field in fields.items()))
    return struct.pack("<I", len(lines)) + lines


class ForgedPublisher:
    """Publishes on a topic to one node under the name of the topic's real publisher."""

    def __init__(self, topic, message, name, subscriber):
        self.topic = topic
        self.header = {"callerid": name, "latching": "0", "md5sum": message._md5sum, "type": message._type, "topic": topic,
                       "message_definition": message._full_text}
        self.subscriber = subscriber
        self.link = None
        self.listener = socket.create_server(("127.0.0.1", 0))
        self.server = xmlrpc.server.SimpleXMLRPCServer(("127.0.0.1", 0), logRequests=False)
        port = self.listener.getsockname()[1]
        self.server.register_function(lambda *_: [1, "ready", ["TCPROS", "localhost", port]], "requestTopic")
        threading.Thread(target=self.server.serve_forever, daemon=True).start()
        threading.Thread(target=self.accept, daemon=True).start()
        self.link_up()

    def link_up(self):
        """Announces one more publisher of the topic to the node, as the master does, and waits for the node to connect."""
        self.link = None
        master = rosgraph.Master("/forger")
        publishers = dict(master.getSystemState()[0]).get(self.topic, [])
        addresses = [master.lookupNode(publisher) for publisher in publishers]
        addresses.append("http://localhost:{}/".format(self.server.server_address[1]))
        with xmlrpc.client.ServerProxy(master.lookupNode(self.subscriber)) as node:
            node.publisherUpdate("/master", self.topic, addresses)
        live_platoon.wait_for(lambda: self.link, "a link from {} for {}".format(self.subscriber, self.topic))

    def accept(self):
        while True:
            link = self.listener.accept()[0]
            link.recv(struct.unpack("<I", link.recv(4, socket.MSG_WAITALL))[0], socket.MSG_WAITALL)
            link.sendall(packed(self.header))
            self.link = link

    def publish(self, message):
        buffer = io.BytesIO()
        message.serialize(buffer)
        framed = struct.pack("<I", len(buffer.getvalue())) + buffer.getvalue()
        try:
            self.link.sendall(framed)
        except OSError:  # the master sent the node its list of publishers, because another node began to publish on the topic
            self.link_up()
            self.link.sendall(framed)
