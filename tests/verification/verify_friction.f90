!> Friction: a ball that slides until it rolls, and bounces that slide from beginning to end.
program verify_friction
  use communicator, only: communicator_t, start_ranks, stop_ranks
  use check, only: finish
  use constants, only: pi
  use contact_settings, only: contact_settings_t
  use des_scenes, only: scene, put, place_of, run
  use kinds, only: wp
  use report, only: check_value, point
  use solids, only: solids_t
  use spring_contact, only: damping_ratio
  implicit none

  real(wp), parameter :: radius = 0.5e-3_wp, usual_ratio = 2.0_wp/7.0_wp
  type(communicator_t) :: comm

  call start_ranks(comm)
  call slides()
  call bounces('glass', 0.97_wp, 0.092_wp)
  call bounces('acetate', 0.87_wp, 0.25_wp)
  call stuck()
  call finish()
  call stop_ranks()

contains

  !> Time, speed and spin at which rolling begins, the farthest from those of a hard ball for five frictions.
  subroutine slides()
    real(wp), parameter :: hard(3) = [2.0_wp, 5.0_wp, 5.0_wp]/7
    real(wp) :: found(3), worst(3), friction
    integer :: fifths

    worst = hard
    do fifths = 1, 5
      friction = 0.2_wp*fifths
      found = rolling(friction)
      where (abs(found - hard) >= abs(worst - hard)) worst = found
      call point('slide_time', friction, found(1), hard(1))
      call point('slide_speed', friction, found(2), hard(2))
      call point('slide_spin', friction, found(3), hard(3))
    end do
    call check_value('slide_time', worst(1), hard(1))
    call check_value('slide_speed', worst(2), hard(2))
    call check_value('slide_spin', worst(3), hard(3))
  end subroutine slides

  !> A ball set down sliding rolls when mu g t/u_0 = 2/7, with u = omega r = 5/7 u_0. The moment lies between the last
  !> step with slip and the first without.
  function rolling(friction) result(found)
    real(wp), intent(in) :: friction  !< [-]
    real(wp) :: found(3)              !< mu g t/u_0, u/u_0, omega r/u_0

    real(wp), parameter :: density = 1.0e4_wp, stiffness = 1.0e4_wp, u_0 = 0.1_wp, gravity = 9.80665_wp
    real(wp), parameter :: weight = density*4*pi/3*radius**3*gravity
    type(solids_t) :: ball
    type(contact_settings_t) :: contact
    real(wp) :: dt, before(3), after(3), share

    contact%stiffness = stiffness
    contact%tangential_ratio = 1.0_wp
    contact%restitution = 1.0_wp
    contact%friction = friction
    ball = scene(comm, [0.05_wp, 0.01_wp, 0.01_wp], -gravity, contact)
    ball%numerics%steps_per_collision = 50
    call put(ball, reshape([0.005_wp, 0.005_wp, radius - weight/stiffness], [3, 1]), &
             reshape([u_0, 0.0_wp, 0.0_wp], [3, 1]), [2*radius], density=[density])
    dt = ball%time_step_limit()
    after = [0.0_wp, u_0, 0.0_wp]
    do
      before = after
      call run(ball, 1, dt)
      after = [ball%time, ball%parcels%state(5, 1), ball%parcels%state(10, 1)]
      if (after(3) >= after(2)) exit
    end do
    share = (before(2) - before(3))/(before(2) - before(3) + after(3) - after(2))
    found = before + share*(after - before)
    found = [friction*gravity*found(1)/u_0, found(2)/u_0, found(3)/u_0]
  end function rolling

  !> Bounces of a ball off a wall and of two balls that slide until the contact ends, so Psi_1 > 7/2 (1 + e), against
  !> hard spheres, Psi_2 = Psi_1 - 7/2 (1 + e), and against the law itself. Its dashpot draws at the end of a contact:
  !> friction takes mu times the impulse of |F_n|, which is m v_n (1 + 2 v'/v_n - e) with the largest speed of the
  !> rebound v'/v_n = e exp(2 phi tan phi), sin phi = zeta. And its tangential spring, with k_t = 2/7 k_n, gives way as
  !> fast as the normal force falls only for Psi_1 > 7/2 (1 + 2 e).
  subroutine bounces(material, restitution, friction)
    character(len=*), intent(in) :: material
    real(wp), intent(in) :: restitution, friction  !< [-]

    real(wp), parameter :: psi_1(5) = [8.0_wp, 10.0_wp, 12.0_wp, 15.0_wp, 20.0_wp]
    real(wp) :: phi, hard, drawn, psi_2(2), error(2, 2)
    integer :: k

    phi = asin(damping_ratio(restitution))
    drawn = restitution*(2*exp(2*phi*tan(phi)) - 2)
    error = 0
    do k = 1, size(psi_1)
      hard = psi_1(k) - 3.5_wp*(1 + restitution)
      psi_2 = [off_wall(psi_1(k), restitution, friction, usual_ratio), of_pair(psi_1(k), restitution, friction, usual_ratio)]
      error(:, 1) = max(error(:, 1), abs(psi_2 - hard))
      if (psi_1(k) > 3.5_wp*(1 + 2*restitution)) error(:, 2) = max(error(:, 2), abs(psi_2 - (hard - 3.5_wp*drawn)))
      call point('oblique_wall_'//material, psi_1(k), psi_2(1), hard)
      call point('oblique_pair_'//material, psi_1(k), psi_2(2), hard)
    end do
    call check_value('oblique_wall_'//material, error(1, 1), 0.0_wp)
    call check_value('oblique_pair_'//material, error(2, 1), 0.0_wp)
    call check_value('oblique_law_wall_'//material, error(1, 2), 0.0_wp)
    call check_value('oblique_law_pair_'//material, error(2, 2), 0.0_wp)
  end subroutine bounces

  !> Bounces with so much friction that the contact point never slides: it swings on the tangential spring and dashpot,
  !> against an inertia of 2/7 m*, for as long as the contact lasts. k_t = k_n/14 makes that a quarter of a swing, where
  !> the outcome depends on k_t the most; gamma_t is half gamma_n.
  subroutine stuck()
    real(wp), parameter :: restitution = 0.9_wp, friction = 1.0e4_wp, ratio = 1.0_wp/14.0_wp, psi_1 = 0.5_wp/friction
    real(wp) :: zeta, duration, decay, omega, expected

    zeta = damping_ratio(restitution)
    duration = pi/sqrt(1 - zeta**2)  ! times omega_0, as the rates below over it
    decay = 3.5_wp*0.5_wp*zeta
    omega = sqrt(3.5_wp*ratio - decay**2)
    expected = exp(-decay*duration)*(cos(omega*duration) - decay/omega*sin(omega*duration))
    call check_value('oblique_stuck_wall', off_wall(psi_1, restitution, friction, ratio)/psi_1, expected)
    call check_value('oblique_stuck_pair', of_pair(psi_1, restitution, friction, ratio)/psi_1, expected)
  end subroutine stuck

  !> Springs so stiff that nothing turns during the contact, in steps of a ten thousandth of it.
  function stiff(restitution, friction, ratio) result(solids)
    real(wp), intent(in) :: restitution, friction, ratio  !< [-], [-], k_t/k_n [-]
    type(solids_t) :: solids

    type(contact_settings_t) :: contact

    contact%stiffness = 5.0e11_wp
    contact%tangential_ratio = ratio
    contact%restitution = restitution
    contact%friction = friction
    solids = scene(comm, [0.01_wp, 0.01_wp, 0.01_wp], 0.0_wp, contact)
    solids%numerics%steps_per_collision = 10000
  end function stiff

  !> Psi_2 of a ball that hits the floor at 1 m/s.
  function off_wall(psi_1, restitution, friction, ratio) result(psi_2)
    real(wp), intent(in) :: psi_1, restitution, friction, ratio  !< [-]
    real(wp) :: psi_2

    type(solids_t) :: ball
    real(wp) :: dt

    ball = stiff(restitution, friction, ratio)
    call put(ball, reshape([0.005_wp, 0.005_wp, (1 + 1.0e-6_wp)*radius], [3, 1]), &
             reshape([psi_1*friction, 0.0_wp, -1.0_wp], [3, 1]), [2*radius])
    dt = ball%time_step_limit()
    do
      call run(ball, 1, dt)
      associate (s => ball%parcels%state(:, 1))
        if (s(3) > radius .and. s(7) > 0) exit
      end associate
    end do
    associate (s => ball%parcels%state(:, 1))
      psi_2 = (s(5) - s(10))/friction
    end associate
  end function off_wall

  !> Psi_2 of two balls that meet at 1 m/s along the line of their centres.
  function of_pair(psi_1, restitution, friction, ratio) result(psi_2)
    real(wp), intent(in) :: psi_1, restitution, friction, ratio  !< [-]
    real(wp) :: psi_2

    type(solids_t) :: balls
    real(wp) :: x(3, 2), v(3, 2), dt, a(11), b(11)

    balls = stiff(restitution, friction, ratio)
    x = 0.005_wp
    x(3, 2) = x(3, 1) - (2 + 1.0e-6_wp)*radius
    v(:, 1) = [psi_1*friction, 0.0_wp, -1.0_wp]/2
    v(:, 2) = -v(:, 1)
    call put(balls, x, v, [2*radius, 2*radius])
    dt = balls%time_step_limit()
    do
      call run(balls, 1, dt)
      a = balls%parcels%state(1:11, place_of(balls, 1))
      b = balls%parcels%state(1:11, place_of(balls, 2))
      if (a(3) - b(3) > 2*radius .and. a(7) > 0) exit
    end do
    psi_2 = (a(5) - b(5) - a(10) - b(10))/friction
  end function of_pair

end program verify_friction
