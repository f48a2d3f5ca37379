!> Attraction: the load it carries, the speed that parts a pair, the speed below which a pair sticks, found by halving.
program verify_cohesion
  use check, only: finish
  use communicator, only: communicator_t, start_ranks, stop_ranks
  use constants, only: pi
  use contact_settings, only: contact_settings_t
  use des_scenes, only: run
  use kinds, only: wp
  use report, only: check_value, point
  use solids, only: solids_t
  use sticky_balls, only: r, m, k, a, near, far, sticky, sticky_by_area, modulus, with_ball, two_balls, gap, parting, well, &
    sticking_speed
  implicit none

  integer, parameter :: halvings = 12
  type(communicator_t) :: comm
  type(contact_settings_t) :: area
  real(wp) :: depth

  call start_ranks(comm)
  area = sticky_by_area(0.3_wp)
  call check_value('pull_van_der_waals', found('hangs', 0.7_wp, 1.4_wp)*a*r/(6*near**2)*1e9_wp, a*r/(6*near**2)*1e9_wp)
  call check_value('pull_area', found('hangs_by_area', 0.7_wp, 1.4_wp)*largest_pull()*1e9_wp, largest_pull()*1e9_wp)
  depth = sqrt(2*sum(well(r/2))/(m/2))
  call check_value('escape_pair', found('stays', 0.7_wp, 1.4_wp)*depth*1e3_wp, depth*1e3_wp)
  depth = sqrt(2*0.1_wp*(pi*area%cohesion_energy*r/2)**5/(4*modulus(area)*sqrt(r/2)/3)**4/(m/2))
  call check_value('escape_area', found('stays_by_area', 0.7_wp, 1.4_wp)*depth*1e3_wp, depth*1e3_wp)
  call sticking()
  call finish()
  call stop_ranks()

contains

  !> Up to which share the answer is yes, between two values.
  function found(question, from, to) result(value)
    character(len=*), intent(in) :: question
    real(wp), intent(in) :: from, to
    real(wp) :: value

    real(wp) :: low, high
    integer :: i

    low = from
    high = to
    do i = 1, halvings
      value = (low + high)/2
      if (holds(question, value)) then
        low = value
      else
        high = value
      end if
    end do
    value = (low + high)/2
  end function found

  function holds(question, share)
    character(len=*), intent(in) :: question
    real(wp), intent(in) :: share
    logical :: holds

    select case (question)
    case ('hangs')
      holds = hangs(share)
    case ('hangs_by_area')
      holds = hangs_by_area(share)
    case ('stays')
      holds = stays(share)
    case ('stays_by_area')
      holds = stays_by_area(share)
    case default
      error stop 'verify_cohesion: no such question'
    end select
  end function holds

  pure function largest_pull()
    real(wp) :: largest_pull

    largest_pull = pi**3/12*area%cohesion_energy**3*r**2/modulus(area)**2
  end function largest_pull

  !> Whether a ball hangs from the ceiling by van der Waals' attraction and weighs `share` of it.
  function hangs(share)
    real(wp), intent(in) :: share
    logical :: hangs

    real(wp), parameter :: most = a*r/(6*near**2)

    hangs = ceiling_holds(sticky(0.5_wp), share*most, max((1 - share)*most/k, 0.0_wp))
  end function hangs

  function hangs_by_area(share)
    real(wp), intent(in) :: share
    logical :: hangs_by_area

    hangs_by_area = ceiling_holds(area, share*largest_pull(), 4*r*(3*pi*area%cohesion_energy/(4*modulus(area)))**2/9)
  end function hangs_by_area

  function ceiling_holds(contact, weight, overlap) result(holds)
    type(contact_settings_t), intent(in) :: contact
    real(wp), intent(in) :: weight, overlap  !< [N], [m]
    logical :: holds

    type(solids_t) :: ball
    real(wp) :: dt

    ball = with_ball(comm, contact, -weight/m, [0.0_wp, 0.0_wp, 0.5e-3_wp - r + overlap], [0.0_wp, 0.0_wp, 0.0_wp])
    dt = ball%time_step_limit()
    call run(ball, nint(0.02_wp/dt), dt)
    holds = ball%parcels%state(3, 1) > 0.9e-3_wp
  end function ceiling_holds

  !> Whether two balls at rest stay together that are struck apart with `share` of the escape velocity.
  function stays(share)
    real(wp), intent(in) :: share
    logical :: stays

    stays = pair_stays(sticky(1.0_wp), -a*(r/2)/(6*near**2)/k, share*depth)
  end function stays

  function stays_by_area(share)
    real(wp), intent(in) :: share
    logical :: stays_by_area

    stays_by_area = pair_stays(sticky_by_area(1.0_wp), -r/2*(3*pi*area%cohesion_energy/(4*modulus(area)))**2, share*depth)
  end function stays_by_area

  !> Whether a pair ends up together. It does if it approaches again.
  function pair_stays(contact, gap_0, speed) result(stays)
    type(contact_settings_t), intent(in) :: contact
    real(wp), intent(in) :: gap_0, speed  !< [m], [m/s]
    logical :: stays

    type(solids_t) :: balls
    real(wp) :: dt

    balls = two_balls(comm, contact, gap_0, speed)
    dt = 0.2_wp*balls%time_step_limit()
    do
      call run(balls, 1, dt)
      stays = parting(balls) < 0
      if (stays .or. gap(balls) > merge(far, 0.0_wp, contact%cohesion == 'van_der_waals')) return
    end do
  end function pair_stays

  !> The speed below which two balls from afar stick, for some restitutions: the worst over its closed form.
  subroutine sticking()
    real(wp), parameter :: restitution(4) = [0.9_wp, 0.8_wp, 0.6_wp, 0.4_wp]
    real(wp) :: worst, critical, low, high, speed
    integer :: i, n

    worst = 1
    do i = 1, size(restitution)
      critical = sticking_speed(restitution(i))
      low = 0.7_wp*critical
      high = 1.4_wp*critical
      do n = 1, halvings
        speed = (low + high)/2
        if (sticks(restitution(i), speed)) then
          low = speed
        else
          high = speed
        end if
      end do
      if (abs(speed/critical - 1) > abs(worst - 1)) worst = speed/critical
      call point('sticking', restitution(i), speed*1e3_wp, critical*1e3_wp)
    end do
    call check_value('sticking', worst, 1.0_wp)
  end subroutine sticking

  function sticks(restitution, speed)
    real(wp), intent(in) :: restitution, speed
    logical :: sticks

    type(solids_t) :: balls
    real(wp) :: dt
    logical :: met

    balls = two_balls(comm, sticky(restitution), 1.1_wp*far, -speed)
    dt = 0.1_wp*balls%time_step_limit()
    met = .false.
    do
      call run(balls, 1, dt)
      met = met .or. gap(balls) < 0
      sticks = .false.
      if (met .and. gap(balls) > far) return
      sticks = .true.
      if (met .and. gap(balls) > 0 .and. parting(balls) < 0) return
    end do
  end function sticks

end program verify_cohesion
