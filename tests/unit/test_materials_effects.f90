!> Rolling friction and attraction of unlike materials: that every pair, of parcels and of a parcel and a wall, has its own, given
!> or mixed, against closed formulas.
!> ranks: 1
program test_materials_effects
  use chamber, only: chamber_t
  use check, only: expect, expect_close, finish
  use communicator, only: communicator_t, start_ranks, stop_ranks
  use constants, only: pi
  use contact_pairs, only: pair_t, pair_of, wall_pair_of
  use contact_settings, only: contact_settings_t
  use des_scenes, only: scene, put, place_of, run
  use des_settings, only: des_settings_t
  use kinds, only: wp
  use material_settings, only: material_settings_t, pair_settings_t
  use mesh_scenes, only: mesh, sheet
  use solids, only: solids_t
  use surface, only: surface_t, new_surface
  use wall_scenes, only: mass_of, plane, cylinder, column, g
  use wall_settings, only: wall_settings_t
  implicit none

  integer, parameter :: n = 3
  real(wp), parameter :: d = 1.0e-3_wp, r = d/2, k = 1000.0_wp, modulus(n) = [1.0e8_wp, 3.0e8_wp, 5.0e7_wp], poisson = 0.25_wp
  real(wp), parameter :: near = 1.0e-7_wp, far = 1.0e-5_wp

  ! Of the three materials. The third attracts nothing; it and the first are known as a pair.
  real(wp), parameter :: mu_r(n) = [0.02_wp, 0.08_wp, 0.3_wp], eta(n) = [0.1_wp, 0.4_wp, 0.2_wp]
  real(wp), parameter :: hamaker(n) = [1.0e-14_wp, 9.0e-14_wp, 0.0_wp], energy(n) = [1.0e5_wp, 4.0e5_wp, 0.0_wp]
  real(wp), parameter :: given(4) = [0.15_wp, 0.3_wp, 5.0e-14_wp, 3.0e5_wp]
  type(communicator_t) :: comm

  call start_ranks(comm)
  call mixing()
  call walls_without_material()
  call pairs_that_roll()
  call swings()
  call stopping_distances()
  call forces('van_der_waals')
  call forces('linear')
  call time_step()
  call shared_by_all()
  call finish()
  call stop_ranks()

contains

  !> Three materials that differ in effects only, one powder of each.
  function three() result(contact)
    type(contact_settings_t) :: contact

    integer :: m

    contact%stiffness = k
    contact%poisson_ratio = poisson
    contact%restitution = 1.0_wp
    contact%friction = 0.8_wp
    contact%minimum_separation = near
    contact%maximum_separation = far
    allocate (contact%materials(n), contact%pairs(1))
    do m = 1, n
      contact%materials(m) = material_settings_t(youngs_modulus=modulus(m), rolling_friction=mu_r(m), rolling_damping=eta(m), &
                                                 hamaker_constant=hamaker(m), cohesion_energy=energy(m))
    end do
    contact%pairs(1) = pair_settings_t(materials=[3, 1], rolling_friction=given(1), rolling_damping=given(2), &
                                       hamaker_constant=given(3), cohesion_energy=given(4))
    allocate (contact%powder_material, source=[1, 2, 3])
  end function three

  !> What the rules say of two of the three: mu_r, eta, A, k.
  pure function rule(a, b) result(values)
    integer, intent(in) :: a, b
    real(wp) :: values(4)

    values = [sqrt(mu_r(a)*mu_r(b)), sqrt(eta(a)*eta(b)), sqrt(hamaker(a)*hamaker(b)), sqrt(energy(a)*energy(b))]
    if (a + b == 4 .and. a /= b) values = given
  end function rule

  pure function effects(pair) result(values)
    type(pair_t), intent(in) :: pair
    real(wp) :: values(4)

    values = [pair%rolling_friction, pair%rolling_damping, pair%hamaker_constant, pair%cohesion_energy]
  end function effects

  pure function name_of(a, b) result(name)
    integer, intent(in) :: a, b
    character(len=3) :: name

    write (name, '(i0,a,i0)') a, '-', b
  end function name_of

  !> Of every pair, in either order and at walls; and what is as in &contact.
  subroutine mixing()
    real(wp), parameter :: scaled(4) = [1.0_wp, 1.0_wp, 9.0_wp, 3.0_wp**(1.0_wp/3.0_wp)]
    type(contact_settings_t) :: contact
    integer :: a, b

    contact = three()
    do a = 1, n
      do b = 1, n
        call expect(all(abs(effects(pair_of(contact, a, b)) - rule(a, b)) <= 1.0e-14_wp*rule(a, b)), 'effects of '//name_of(a, b))
        call expect(all(abs(effects(wall_pair_of(contact, a, b)) - rule(a, b)) <= 1.0e-14_wp*rule(a, b)), 'and of one and a wall')
      end do
    end do
    contact%coarseness = 3.0_wp
    contact%cohesion_scaling = 'bond_number'
    do a = 1, n
      call expect(all(abs(effects(pair_of(contact, a, 3)) - rule(a, 3)*scaled) <= 1.0e-14_wp*rule(a, 3)*scaled), &
                  'parcels attract as the weight of '//name_of(a, 3)//' asks for, and roll as particles do')
    end do
    contact%cohesion_scaling = 'none'
    contact%materials(1) = material_settings_t()
    contact%rolling_friction = 0.5_wp
    contact%rolling_damping = 0.6_wp
    contact%hamaker_constant = 4.0e-14_wp
    contact%cohesion_energy = 1.0e6_wp
    call expect(.not. any(abs(effects(pair_of(contact, 1, 1)) - [0.5_wp, 0.6_wp, 4.0e-14_wp, 1.0e6_wp]) > 0), &
                'a material that does not say is as &contact, to the last bit')
    call expect(all(abs(effects(pair_of(contact, 0, 2))/[0.2_wp, sqrt(0.24_wp), 6.0e-14_wp, sqrt(4.0e11_wp)] - 1) < 1.0e-14_wp), &
                'and so is a powder without')
  end subroutine mixing

  !> A wall of no material is as the parcel that touches it, or as &contact says of walls.
  subroutine walls_without_material()
    type(contact_settings_t) :: contact

    contact = three()
    call expect(.not. any(abs(effects(wall_pair_of(contact, 2, 0)) - rule(2, 2)) > 0), 'a wall of no material is as the parcel')
    contact%wall_rolling_friction = 0.7_wp
    contact%wall_hamaker_constant = 2.0e-14_wp
    contact%wall_cohesion_energy = 2.0e5_wp
    call expect(.not. any(abs(effects(wall_pair_of(contact, 2, 0)) - [0.7_wp, eta(2), 2.0e-14_wp, 2.0e5_wp]) > 0), &
                'or as &contact says of walls')
    call expect(.not. any(abs(effects(wall_pair_of(contact, 2, 2)) - rule(2, 2)) > 0), 'which is not of walls that have one')
  end subroutine walls_without_material

  !> Two balls that meet head on, turning against each other so that nothing slides, roll on each other while they bounce: the
  !> torque mu_r R F makes of the impulse, 2 m v, a loss of omega r of 5/2 mu_r v for each.
  subroutine pairs_that_roll()
    real(wp), parameter :: speed = 0.05_wp, turning = 0.3_wp
    type(contact_settings_t) :: contact
    type(solids_t) :: balls
    real(wp) :: values(4)
    integer :: a, b, i

    contact = three()
    contact%rolling = 'constant_torque'
    do a = 1, n
      do b = a, n
        balls = scene(comm, [10*d, 10*d, 10*d], 0.0_wp, contact)
        call put(balls, reshape([4.4995_wp, 5.0_wp, 5.0_wp, 5.5005_wp, 5.0_wp, 5.0_wp]*d, [3, 2]), &
                 reshape([1.0_wp, 0.0_wp, 0.0_wp, -1.0_wp, 0.0_wp, 0.0_wp]*speed, [3, 2]), [d, d], powder=[b, a])
        do i = 1, 2
          balls%parcels%state(10, place_of(balls, i)) = turning*(3 - 2*i)
        end do
        call run(balls, 1500, pi*sqrt(mass_of(d)/2/k)/1000)
        values = rule(a, b)
        associate (one => balls%parcels%state(:, place_of(balls, 1)), other => balls%parcels%state(:, place_of(balls, 2)))
          call expect_close(-one(5), speed, 1.0e-3_wp, 'elastic, they part as they met')
          call expect_close((turning - one(10))/(2.5_wp*speed), values(1), 2.0e-3_wp, 'rolling friction of '//name_of(a, b))
          call expect_close(one(10) + other(10), 0.0_wp, 1.0e-12_wp, 'the same of both')
        end associate
      end do
    end do
  end subroutine pairs_that_roll

  !> Pressed together, they are a damped swing of their rolling spring: theta'' = -k_r theta - C_r theta' over I/2.
  subroutine swings()
    real(wp), parameter :: wider = 20.0_wp, omega = 1.0e-3_wp
    type(contact_settings_t) :: contact
    type(solids_t) :: balls
    real(wp) :: x(3, 2), values(4), inertia, k_r, decay, swing, dt, worst
    integer :: a, b, step

    contact = three()
    contact%rolling = 'spring'
    contact%materials%rolling_friction = wider*mu_r
    contact%pairs(1)%rolling_friction = wider*given(1)
    x = 5*d
    x(1, 2) = 5*d + 0.99_wp*d
    inertia = 0.4_wp*mass_of(d)*r**2/2
    do a = 1, n
      do b = a, n
        values = rule(a, b)
        k_r = 2.25_wp*k*(wider*values(1)*r/2)**2
        decay = values(2)*sqrt(k_r*0.7_wp*mass_of(d)*r**2)/inertia
        swing = sqrt(k_r/inertia - decay**2)
        balls = scene(comm, [10*d, 10*d, 10*d], 0.0_wp, contact)
        call put(balls, x, 0*x, [d, d], powder=[a, b])
        balls%parcels%state(10, place_of(balls, 1)) = omega*r
        balls%parcels%state(10, place_of(balls, 2)) = -omega*r
        dt = 0.02_wp*balls%time_step_limit()
        worst = 0
        do step = 1, int(min(4/swing, 0.2_wp*pi*sqrt(mass_of(d)/2/k))/dt)
          call run(balls, 1, dt)
          associate (t => balls%time)
            worst = max(worst, abs(balls%parcels%state(10, place_of(balls, 1))/(omega*r) &
                                   - exp(-decay*t)*(cos(swing*t) - decay/swing*sin(swing*t))))
          end associate
        end do
        call expect(decay*balls%time > 1.0e-2_wp, 'the dashpot has done something')
        call expect_close(worst, 0.0_wp, 2.0e-4_wp, 'rolling spring and damping of '//name_of(a, b))
      end do
    end do
  end subroutine swings

  !> A ball that rolls on a floor with u stops after 7/10 u^2/(mu_r g).
  subroutine stopping_distances()
    real(wp), parameter :: speed = 0.03_wp
    type(contact_settings_t) :: contact
    type(chamber_t) :: chamber
    type(solids_t) :: ball
    real(wp) :: values(4), dt
    integer :: a, b

    contact = three()
    contact%rolling = 'constant_torque'
    contact%restitution = 0.5_wp
    do a = 1, n
      do b = 0, n
        values = rule(a, a)
        if (b > 0) values = rule(a, b)
        chamber%lower = 0.0_wp
        chamber%upper = [0.01_wp, 0.01_wp, 0.01_wp]
        chamber%gravity = [0.0_wp, 0.0_wp, -g]
        chamber%face_material = [0, 0, 0, 0, b, 1]
        call ball%create(comm, chamber, contact, des_settings_t(), .false., 0.0_wp)
        call put(ball, column([d, 5*d, r - mass_of(d)*g/k]), column([speed, 0.0_wp, 0.0_wp]), [d], powder=[a])
        ball%parcels%state(10, 1) = speed
        dt = ball%time_step_limit()
        call run(ball, nint(1.05_wp*1.4_wp*speed/(values(1)*g)/dt), dt)
        call expect_close((ball%parcels%state(1, 1) - d)/(0.7_wp*speed**2/(values(1)*g)), 1.0_wp, 3.0e-3_wp, &
                          'stopping distance of '//name_of(a, b)//' of the floor')
        call expect_close(ball%parcels%state(5, 1), 0.0_wp, 1.0e-4_wp*speed, 'where it stays')
      end do
    end do
  end subroutine stopping_distances

  !> A box with a floor of the first material, a roof of the second, a plane and a rod of the third, a mesh of the second, and sides
  !> of none.
  function box(contact) result(solids)
    type(contact_settings_t), intent(in) :: contact
    type(solids_t) :: solids

    type(wall_settings_t) :: walls(3)
    type(surface_t) :: surfaces(3)
    type(chamber_t) :: chamber

    chamber%lower = 0.0_wp
    chamber%upper = 10*d
    chamber%face_material = [0, 0, 0, 0, 1, 2]
    walls = [plane([0.0_wp, 3*d, 0.0_wp], [0.0_wp, 1.0_wp, 0.0_wp]), mesh(), &
             cylinder([0.0_wp, 6*d, 5*d], [1.0_wp, 0.0_wp, 0.0_wp], d/2)]
    walls%material = [3, 2, 3]
    walls(3)%side = 'outside'
    surfaces(2) = new_surface(sheet([8*d, 0.0_wp, 0.0_wp], [0.0_wp, 10*d, 0.0_wp], [0.0_wp, 0.0_wp, 10*d], [9, 9], 0.2_wp))
    call chamber%add_walls(walls, surfaces)
    call solids%create(comm, chamber, contact, des_settings_t(), .false., 0.0_wp)
  end function box

  !> The force of a step, from what it makes of rest: of two balls, and of a ball and each wall.
  subroutine forces(cohesion)
    character(len=*), intent(in) :: cohesion

    real(wp), parameter :: dt = 1.0e-9_wp
    type(contact_settings_t) :: contact
    type(solids_t) :: balls
    real(wp) :: gap, force, x(3, 2)
    integer :: a, b, i

    contact = three()
    contact%friction = 0.0_wp
    contact%cohesion = cohesion
    gap = 2.0e-6_wp
    if (cohesion == 'linear') then
      contact%law = 'hertz'
      gap = -2.0e-6_wp
    end if
    contact%wall_hamaker_constant = 2.0e-14_wp
    contact%wall_cohesion_energy = 2.0e5_wp
    x = 5*d
    x(1, 2) = 6*d + gap
    do a = 1, n
      do b = a, n
        balls = scene(comm, [20*d, 20*d, 20*d], 0.0_wp, contact)
        call put(balls, x, 0*x, [d, d], powder=[a, b])
        call run(balls, 1, dt)
        do i = 1, 2
          force = (3 - 2*i)*mass_of(d)*balls%parcels%state(5, place_of(balls, i))/dt
          call expect_close(force - pull(cohesion, rule(a, b), [modulus(a), modulus(b)], r/2, gap), 0.0_wp, &
                            1.0e-9_wp*scale_of(cohesion), cohesion//' between '//name_of(a, b))
        end do
      end do
      call towards_wall(contact, [5*d, 5*d, r + gap], [0.0_wp, 0.0_wp, -1.0_wp], a, 1, gap)
      call towards_wall(contact, [5*d, 5*d, 10*d - r - gap], [0.0_wp, 0.0_wp, 1.0_wp], a, 2, gap)
      call towards_wall(contact, [2*d, 3*d + r + gap, 5*d], [0.0_wp, -1.0_wp, 0.0_wp], a, 3, gap)
      call towards_wall(contact, [2*d, 6*d + d/2 + r + gap, 5*d], [0.0_wp, -1.0_wp, 0.0_wp], a, 3, gap)
      call towards_wall(contact, [8*d - r - gap, 8.1_wp*d, 2.3_wp*d], [1.0_wp, 0.0_wp, 0.0_wp], a, 2, gap)
      call towards_wall(contact, [5*d, 10*d - r - gap, 5*d], [0.0_wp, 1.0_wp, 0.0_wp], a, 0, gap)
    end do
  end subroutine forces

  subroutine towards_wall(contact, place, direction, powder, wall, gap)
    type(contact_settings_t), intent(in) :: contact
    real(wp), intent(in) :: place(3), direction(3), gap
    integer, intent(in) :: powder, wall  !< material of the latter

    real(wp), parameter :: dt = 1.0e-9_wp
    type(solids_t) :: ball
    real(wp) :: values(4), both(2)
    character(len=:), allocatable :: cohesion

    cohesion = trim(contact%cohesion)
    values = [0.0_wp, 0.0_wp, contact%wall_hamaker_constant, contact%wall_cohesion_energy]
    both = modulus(powder)
    if (wall > 0) then
      values = rule(powder, wall)
      both(2) = modulus(wall)
    end if
    ball = box(contact)
    call put(ball, column(place), column([0.0_wp, 0.0_wp, 0.0_wp]), [d], powder=[powder])
    call run(ball, 1, dt)
    call expect_close(norm2(mass_of(d)*ball%parcels%state(5:7, 1)/dt - pull(cohesion, values, both, r, gap)*direction), 0.0_wp, &
                      1.0e-9_wp*scale_of(cohesion), cohesion//' of '//name_of(powder, wall)//' of a wall')
  end subroutine towards_wall

  !> A R/(6 h^2); or k pi R delta less Hertz's 4/3 E sqrt(R delta) delta, with 1/E = sum (1 - nu^2)/E_i.
  pure function pull(cohesion, values, moduli, width, gap) result(force)
    character(len=*), intent(in) :: cohesion
    real(wp), intent(in) :: values(4), moduli(2), width, gap
    real(wp) :: force

    if (cohesion == 'van_der_waals') then
      force = values(3)*width/(6*gap**2)
    else
      force = pi*values(4)*width*abs(gap) - 4*sqrt(width*abs(gap))*abs(gap)/(3*(1 - poisson**2)*sum(1/moduli))
    end if
  end function pull

  !> A force of this order [N].
  pure function scale_of(cohesion) result(force)
    character(len=*), intent(in) :: cohesion
    real(wp) :: force

    force = merge(1.0e-14_wp*r/(6*2.0e-6_wp**2), pi*1.0e5_wp*r*2.0e-6_wp, cohesion == 'van_der_waals')
  end function scale_of

  !> The steepest attraction of any pair sets the step, walls' included.
  subroutine time_step()
    type(contact_settings_t) :: contact
    type(solids_t) :: ball

    contact = three()
    contact%cohesion = 'van_der_waals'
    contact%minimum_separation = 1.0e-9_wp
    ball = box(contact)
    call put(ball, column([5*d, 5*d, 5*d]), column([0.0_wp, 0.0_wp, 0.0_wp]), [d], powder=[1])
    call expect_close(ball%time_step_limit(), pi*sqrt(3*1.0e-27_wp*mass_of(d)/(9.0e-14_wp*r))/20, 1.0e-12_wp, &
                      'the step is that of the strongest attraction')
  end subroutine time_step

  !> Materials that do not differ in effects have one law; where they do each has what it needs only.
  subroutine shared_by_all()
    type(contact_settings_t) :: contact
    type(solids_t) :: solids

    contact = three()
    contact%rolling = 'spring'
    contact%cohesion = 'van_der_waals'
    contact%materials = material_settings_t()
    contact%rolling_friction = 0.2_wp
    contact%hamaker_constant = 1.0e-14_wp
    deallocate (contact%pairs)
    allocate (contact%pairs(0))
    solids = box(contact)
    call expect(size(solids%laws%pair) == 1 .and. size(solids%laws%wall) == 1 .and. .not. allocated(solids%parts), &
                'materials that share all effects have one law')
    contact%materials(3)%rolling_friction = 0.0_wp
    contact%materials(3)%hamaker_constant = 0.0_wp
    solids = box(contact)
    call expect(size(solids%laws%pair) == 2 .and. count(solids%laws%pair%rolling%on) == 1 &
                .and. count(solids%laws%pair%rolling%spring) == 1 .and. count(solids%laws%pair%cohesion%on) == 1, &
                'a pair without an effect has nothing of it')
  end subroutine shared_by_all

end program test_materials_effects
