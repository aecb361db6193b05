// One request on a connection of its own, without hello: for a stop by somebody whom the robot does not know, or while the link is lost.

import { Refused, socketAddress } from "./link.js";
import { attributes, elements, request } from "./wire.js";

const ANSWER_MS = 3000;

/** The promise is the direct answer, and fails with `Refused`. */
export function askOnce(tag, given = {}) {
  return new Promise((resolve, reject) => {
    const socket = new WebSocket(socketAddress());
    const fail = (fault) => reject(new Refused([fault]));
    const timer = setTimeout(() => {
      fail({ code: "no-answer", text: `no answer to ${tag} within ${ANSWER_MS / 1000} s: use the robot's own switch` });
      socket.close();
    }, ANSWER_MS);
    socket.onopen = () => socket.send(request(tag, { id: "1", ...given }));
    socket.onclose = () => {
      clearTimeout(timer);
      fail({ code: "no-link", text: "no link: use the robot's own switch" }); // nothing, if it was answered
    };
    socket.onmessage = ({ data }) => {
      const [answer] = elements(data).filter((element) => ["ok", "error"].includes(element.tagName)).map(attributes);
      if (!answer) return;
      answer.tag === "ok" ? resolve(answer) : fail(answer);
      socket.close();
    };
  });
}
