!> Resistance to rolling: braking, slopes, swings of the rolling spring.
program verify_rolling
  use chamber, only: chamber_t
  use check, only: finish
  use communicator, only: communicator_t, start_ranks, stop_ranks
  use constants, only: pi
  use contact_settings, only: contact_settings_t
  use des_scenes, only: put, run
  use des_settings, only: des_settings_t
  use kinds, only: wp
  use report, only: check_value, point
  use solids, only: solids_t
  implicit none

  real(wp), parameter :: gravity = 9.80665_wp, radius = 0.5e-3_wp, stiffness = 1000.0_wp, mass = 2500*4*pi/3*radius**3
  type(communicator_t) :: comm

  call start_ranks(comm)
  call braking('constant_torque', 'roll_brake_torque')
  call braking('spring', 'roll_brake_spring')
  call slopes()
  call repose()
  call swing()
  call finish()
  call stop_ranks()

contains

  function resisting(rolling, mu) result(contact)
    character(len=*), intent(in) :: rolling
    real(wp), intent(in) :: mu
    type(contact_settings_t) :: contact

    contact%stiffness = stiffness
    contact%tangential_ratio = 1.0_wp
    contact%restitution = 0.5_wp
    contact%friction = 0.8_wp
    contact%rolling = rolling
    contact%rolling_friction = mu
  end function resisting

  !> A ball in its dent on the floor, where gravity pulls at an angle [rad].
  function on_floor(contact, angle, speed) result(ball)
    type(contact_settings_t), intent(in) :: contact
    real(wp), intent(in) :: angle, speed
    type(solids_t) :: ball

    type(chamber_t) :: chamber
    real(wp) :: x(3, 1), v(3, 1)

    chamber%lower = 0.0_wp
    chamber%upper = [0.04_wp, 0.01_wp, 0.01_wp]
    chamber%gravity = gravity*[sin(angle), 0.0_wp, -cos(angle)]
    call ball%create(comm, chamber, contact, des_settings_t(), .false., 0.0_wp)
    ball%numerics%steps_per_collision = 50
    x(:, 1) = [0.01_wp, 0.005_wp, radius - mass*gravity*cos(angle)/stiffness]
    v(:, 1) = [speed, 0.0_wp, 0.0_wp]
    call put(ball, x, v, [2*radius])
    ball%parcels%state(10, 1) = speed
  end function on_floor

  !> Mean acceleration over 20 ms, after 10 ms.
  function acceleration(contact, angle, speed) result(mean)
    type(contact_settings_t), intent(in) :: contact
    real(wp), intent(in) :: angle, speed
    real(wp) :: mean

    type(solids_t) :: ball
    real(wp) :: dt, time, before

    ball = on_floor(contact, angle, speed)
    dt = ball%time_step_limit()
    call run(ball, nint(0.01_wp/dt), dt)
    time = ball%time
    before = ball%parcels%state(5, 1)
    call run(ball, nint(0.02_wp/dt), dt)
    mean = (ball%parcels%state(5, 1) - before)/(ball%time - time)
  end function acceleration

  !> A ball that rolls on a plane loses 5/7 mu_r g: the worst of five.
  subroutine braking(rolling, name)
    character(len=*), intent(in) :: rolling, name

    real(wp), parameter :: mu(5) = [0.01_wp, 0.02_wp, 0.05_wp, 0.1_wp, 0.2_wp]
    real(wp) :: found(5), exact(5)
    integer :: i

    do i = 1, 5
      found(i) = -acceleration(resisting(rolling, mu(i)), 0.0_wp, 0.2_wp)
    end do
    exact = 5*mu*gravity/7
    i = maxloc(abs(found/exact - 1), 1)
    call check_value(name, found(i), exact(i))
  end subroutine braking

  !> Down a slope a ball gains 5/7 g (sin a - mu_r cos a).
  subroutine slopes()
    real(wp), parameter :: mu = 0.1_wp, angle(4) = [0.15_wp, 0.2_wp, 0.3_wp, 0.5_wp]
    real(wp) :: found(4), exact(4)
    integer :: i

    do i = 1, 4
      found(i) = acceleration(resisting('spring', mu), angle(i), 0.0_wp)
    end do
    exact = 5*gravity/7*(sin(angle) - mu*cos(angle))
    i = maxloc(abs(found/exact - 1), 1)
    call check_value('roll_slope', found(i), exact(i))
  end subroutine slopes

  !> The steepest slope on which the spring holds a ball: tan a = mu_r. Let loose at once the ball would swing beyond, so the
  !> slope is raised little by little.
  subroutine repose()
    real(wp), parameter :: mu = 0.1_wp
    type(solids_t) :: ball
    real(wp) :: dt, tangent, angle

    ball = on_floor(resisting('spring', mu), 0.0_wp, 0.0_wp)
    dt = ball%time_step_limit()
    tangent = 0.095_wp
    do
      angle = atan(tangent)
      ball%chamber%gravity = gravity*[sin(angle), 0.0_wp, -cos(angle)]
      call run(ball, 400, dt)
      if (ball%parcels%state(5, 1) > 2.0e-6_wp .and. tangent > 0.096_wp .or. tangent > 2*mu) exit
      tangent = tangent + 1.0e-4_wp
    end do
    call check_value('roll_repose', tangent, mu)
  end subroutine repose

  !> Frequency of a ball on a plane on its rolling and tangential springs, undamped: the lower one of
  !> m x'' = -k_t (x - s), 2/5 m s'' = k_t (x - s) - k_r/r^2 s.
  subroutine swing()
    real(wp), parameter :: mu = 0.2_wp
    type(contact_settings_t) :: contact
    type(solids_t) :: ball
    real(wp) :: dt, k_r, half, square, now, before, crossing(2)
    integer :: n

    contact = resisting('spring', mu)
    contact%restitution = 1.0_wp
    contact%rolling_damping = 0.0_wp
    ball = on_floor(contact, 0.0_wp, 1.0e-6_wp)
    dt = ball%time_step_limit()
    k_r = 2.25_wp*stiffness*mu**2
    half = (stiffness/mass + (stiffness + k_r)/(0.4_wp*mass))/2
    square = half - sqrt(half**2 - stiffness*k_r/(0.4_wp*mass**2))
    n = 0
    before = 1
    crossing = 0
    do while (n < 7)
      call run(ball, 1, dt)
      now = ball%parcels%state(1, 1) - 0.01_wp
      if (ball%time > 10*dt .and. now*before < 0) then
        n = n + 1
        if (n == 1) crossing(1) = ball%time - dt*now/(now - before)
        crossing(2) = ball%time - dt*now/(now - before)
      end if
      before = now
    end do
    call check_value('roll_swing', 6*pi/(crossing(2) - crossing(1)), sqrt(square))
  end subroutine swing

end program verify_rolling
