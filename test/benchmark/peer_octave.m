% The paper's Monte Carlo in Octave, vectorised over chunks of realizations: one filter call per vehicle and chunk. Prints JSON.
% Usage: octave --no-gui peer_octave.m REALIZATIONS CHUNK

arguments = argv();
realizations = str2double(arguments{1});
chunk = str2double(arguments{2});
followers = 20; steps = 100; headway = 3.2; noise = 0.6; speed = 20; period = 0.1;

gain = 1.35 / (1 + headway);
denominator = conv([1 0.89], [1 -2 1]) + [0 0 gain * (1 + headway) -gain * headway];
numerator = [0 0 gain];  % T = gain z / D(z), in powers of 1/z

k = (-1:steps - 1)';
y0 = filter(numerator, denominator, max(k, 0) * period * speed);
total = zeros(steps, followers);
squares = zeros(steps, followers);
deviation = sqrt(noise);

began = tic();
done = 0;
while done < realizations
  ahead = repmat(y0, 1, chunk);
  for i = 1:followers
    received = ahead;
    received(2:end, :) += deviation * randn(steps, chunk);  % nothing at step -1
    own = filter(numerator, denominator, received);
    zeta = ahead(2:end, :) - (1 + headway) * own(2:end, :) + headway * own(1:end - 1, :);
    total(:, i) += sum(zeta, 2);
    squares(:, i) += sumsq(zeta, 2);
    ahead = own;
  end
  done += chunk;
end
seconds = toc(began);
mean_error = total / done;
variance = (squares - done * mean_error .^ 2) / (done - 1);
printf('{"vehicle_steps_per_second": %g, "seconds": %g, "last_variance": %.6g}\n', followers * steps * done / seconds, ...
       seconds, variance(end, end));
