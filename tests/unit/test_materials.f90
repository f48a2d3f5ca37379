!> Contacts of unlike materials: how properties of pairs follow from the materials', and that every pair, of parcels and of a
!> parcel and a wall, bounces and slides with its own, against closed formulas.
!> ranks: 1
program test_materials
  use chamber, only: chamber_t
  use check, only: expect, expect_close, finish
  use communicator, only: communicator_t, start_ranks, stop_ranks
  use constants, only: pi
  use contact_pairs, only: pair_t, pair_of, wall_pair_of
  use contact_settings, only: contact_settings_t
  use des_scenes, only: scene, put, run
  use des_settings, only: des_settings_t
  use kinds, only: wp
  use material_settings, only: material_settings_t, pair_settings_t
  use solids, only: solids_t
  use wall_scenes, only: mass_of, plane, cylinder, column
  use wall_settings, only: wall_settings_t
  implicit none

  integer, parameter :: n = 3
  real(wp), parameter :: k(n) = [1000.0_wp, 4000.0_wp, 2000.0_wp], e(n) = [0.9_wp, 0.5_wp, 0.7_wp], mu(n) = [0.2_wp, 0.5_wp, 0.3_wp]
  real(wp), parameter :: modulus(n) = [1.0e8_wp, 3.0e8_wp, 5.0e7_wp], poisson(n) = [0.2_wp, 0.3_wp, 0.45_wp]
  type(communicator_t) :: comm

  call start_ranks(comm)
  call mixing()
  call bounces()
  call slides()
  call hertzian()
  call walls_of_two_materials()
  call corner()
  call time_step()
  call time_step_of_hertz()
  call equal_materials()
  call dealt_or_not()
  call finish()
  call stop_ranks()

contains

  !> Three materials, one powder of each; the first and the third are known as a pair.
  function three(law) result(contact)
    character(len=*), intent(in) :: law
    type(contact_settings_t) :: contact

    integer :: m

    contact%law = law
    allocate (contact%materials(n), contact%pairs(1))
    do m = 1, n
      contact%materials(m) = material_settings_t('', k(m), modulus(m), poisson(m), e(m), mu(m))
    end do
    contact%pairs(1) = pair_settings_t(['c', 'a'], [3, 1], stiffness=3000.0_wp, restitution=0.6_wp, friction=0.1_wp)
    allocate (contact%powder_material, source=[1, 2, 3])
  end function three

  !> What the rules say of two of the three.
  pure subroutine rule(a, b, k_ab, e_ab, mu_ab)
    integer, intent(in) :: a, b
    real(wp), intent(out) :: k_ab, e_ab, mu_ab

    k_ab = 1/(0.5_wp/k(a) + 0.5_wp/k(b))
    e_ab = exp(0.5_wp*(log(e(a)) + log(e(b))))
    mu_ab = exp(0.5_wp*(log(mu(a)) + log(mu(b))))
    if (a + b /= 4 .or. a == b) return
    k_ab = 3000.0_wp
    e_ab = 0.6_wp
    mu_ab = 0.1_wp
  end subroutine rule

  !> Of every pair, in either order; and what is as in &contact.
  subroutine mixing()
    type(contact_settings_t) :: contact
    type(pair_t) :: pair, turned
    real(wp) :: k_ab, e_ab, mu_ab
    character(len=3) :: name
    integer :: a, b

    contact = three('linear')
    do a = 1, n
      do b = 1, n
        call rule(a, b, k_ab, e_ab, mu_ab)
        pair = pair_of(contact, a, b)
        turned = pair_of(contact, b, a)
        write (name, '(i0,a,i0)') a, '-', b
        call expect_close(pair%stiffness, k_ab, 1.0e-14_wp, 'stiffness of '//name)
        call expect_close(pair%restitution, e_ab, 1.0e-14_wp, 'restitution of '//name)
        call expect_close(pair%friction, mu_ab, 1.0e-14_wp, 'friction of '//name)
        call expect(.not. (abs(pair%stiffness - turned%stiffness) > 0 .or. abs(pair%restitution - turned%restitution) > 0 &
                           .or. abs(pair%friction - turned%friction) > 0), 'the same in either order')
      end do
    end do
    contact%stiffness = 500.0_wp
    contact%friction = 0.8_wp
    contact%materials(1)%stiffness = -huge(1.0_wp)
    contact%wall_friction = 0.05_wp
    pair = pair_of(contact, 1, 2)
    call expect_close(pair%stiffness, 8000.0_wp/9, 1.0e-14_wp, 'a material that does not say is as &contact')
    pair = pair_of(contact, 0, 1)
    call expect_close(pair%friction, 0.4_wp, 1.0e-14_wp, 'and so is a powder without')
    pair = wall_pair_of(contact, 2, 0)
    call expect_close(pair%friction, 0.05_wp, 0.0_wp, 'a wall without material has what &contact says of walls')
    call expect_close(pair%restitution, e(2), 0.0_wp, 'and else what the parcel has')
    contact%pairs(1)%tangential_ratio = 0.9_wp
    pair = wall_pair_of(contact, 3, 1)
    call expect_close(pair%restitution, 0.6_wp, 0.0_wp, 'a wall of a material is a partner like others')
    call expect_close(pair%tangential_ratio, 0.9_wp, 0.0_wp, 'and what the pair says holds')
  end subroutine mixing

  !> Two parcels of each pair of powders meet head on: restitution and depth are those of the pair's own oscillator.
  subroutine bounces()
    real(wp), parameter :: speed = 0.2_wp, d = 1.0e-3_wp
    type(solids_t) :: pair
    real(wp) :: k_ab, e_ab, mu_ab, zeta, omega, dt, deepest, gap
    character(len=3) :: name
    integer :: a, b

    do a = 1, n
      do b = a, n
        call rule(a, b, k_ab, e_ab, mu_ab)
        zeta = -log(e_ab)/sqrt(pi**2 + log(e_ab)**2)
        omega = sqrt(k_ab/(mass_of(d)/2))
        dt = pi/omega/1000
        pair = scene(comm, [10*d, 10*d, 10*d], 0.0_wp, three('linear'))
        call put(pair, reshape([4.4995_wp, 5.0_wp, 5.0_wp, 5.5005_wp, 5.0_wp, 5.0_wp]*d, [3, 2]), &
                 reshape([0.5_wp, 0.0_wp, 0.0_wp, -0.5_wp, 0.0_wp, 0.0_wp]*speed, [3, 2]), [d, d], powder=[b, a])
        deepest = 0.0_wp
        do
          call run(pair, 1, dt)
          gap = abs(pair%parcels%state(1, 1) - pair%parcels%state(1, 2)) - d
          deepest = min(deepest, gap)
          if (gap > 0.0_wp .and. deepest < 0.0_wp) exit
        end do
        write (name, '(i0,a,i0)') a, '-', b
        call expect_close(abs(pair%parcels%state(5, 1) - pair%parcels%state(5, 2))/speed, e_ab, 1.0e-3_wp, 'bounce of '//name)
        call expect_close(-deepest, speed/omega*exp(-zeta/sqrt(1 - zeta**2)*acos(zeta)), 1.0e-3_wp, 'depth of '//name)
      end do
    end do
  end subroutine bounces

  !> Grazing elastic hits slide throughout: the tangential impulse is mu times the normal one.
  subroutine slides()
    real(wp), parameter :: d = 1.0e-3_wp, v_n = 0.002_wp, v_t = 0.1_wp
    type(contact_settings_t) :: contact
    type(solids_t) :: pair
    real(wp) :: k_ab, e_ab, mu_ab, dt, time, v(3, 2)
    character(len=3) :: name
    integer :: a, b

    contact = three('linear')
    contact%materials%restitution = 1.0_wp
    contact%materials%stiffness = 5.0e6_wp
    contact%pairs(1)%restitution = 1.0_wp
    contact%pairs(1)%stiffness = 5.0e6_wp
    v(:, 1) = 0.5_wp*[v_t, 0.0_wp, v_n]
    v(:, 2) = -v(:, 1)
    time = pi*sqrt(mass_of(d)/2/5.0e6_wp)
    do a = 1, n
      do b = a, n
        call rule(a, b, k_ab, e_ab, mu_ab)
        pair = scene(comm, [10*d, 10*d, 10*d], 0.0_wp, contact)
        dt = time/400
        ! In the middle of the contact they are one above the other.
        call put(pair, reshape([-0.5_wp*v_t*0.6_wp*time, 0.0_wp, -0.5_wp*(d + 0.1_wp*v_n*time), &
                                0.5_wp*v_t*0.6_wp*time, 0.0_wp, 0.5_wp*(d + 0.1_wp*v_n*time)] + 5*d, [3, 2]), v, [d, d], &
                 powder=[a, b])
        call run(pair, 600, dt)
        write (name, '(i0,a,i0)') a, '-', b
        associate (gain => abs(pair%parcels%state(5:7, 1) - pair%parcels%state(5:7, 2)))
          call expect_close(gain(3), v_n, 1.0e-2_wp, 'elastic, they part as they met')
          call expect_close((v_t - gain(1))/(v_n + gain(3)), mu_ab, 2.0e-3_wp, 'friction of '//name)
        end associate
      end do
    end do
  end subroutine slides

  !> The deepest overlap of an elastic collision of unlike materials: Timoshenko and Goodier, Theory of Elasticity, sec. 142.
  subroutine hertzian()
    real(wp), parameter :: d = 1.0e-3_wp, speed = 1.0_wp
    type(contact_settings_t) :: contact
    type(solids_t) :: pair
    real(wp) :: together, expected, deepest
    character(len=3) :: name
    integer :: a, b, step

    contact = three('hertz')
    contact%materials%restitution = 1.0_wp
    contact%pairs(1)%restitution = 1.0_wp
    do a = 1, n
      do b = a, n
        pair = scene(comm, [10*d, 10*d, 10*d], 0.0_wp, contact)
        call put(pair, reshape([4.4995_wp, 5.0_wp, 5.0_wp, 5.5005_wp, 5.0_wp, 5.0_wp]*d, [3, 2]), &
                 reshape([0.5_wp, 0.0_wp, 0.0_wp, -0.5_wp, 0.0_wp, 0.0_wp]*speed, [3, 2]), [d, d], powder=[a, b])
        together = 1/((1 - poisson(a)**2)/modulus(a) + (1 - poisson(b)**2)/modulus(b))
        expected = (15*mass_of(d)/2*speed**2/(16*together*sqrt(d/4)))**0.4_wp
        deepest = 0.0_wp
        do step = 1, 4000
          call run(pair, 1, expected/speed/300)
          deepest = max(deepest, d - abs(pair%parcels%state(1, 1) - pair%parcels%state(1, 2)))
          if (pair%parcels%state(5, 1) < 0.0_wp) exit
        end do
        write (name, '(i0,a,i0)') a, '-', b
        call expect_close(deepest, expected, 1.0e-4_wp, 'depth of Hertz''s contact of '//name)
      end do
    end do
  end subroutine hertzian

  !> A box with a floor of the first material, a roof of the second, a plane and a pipe of the third, and walls of none: a ball
  !> of the second bounces off each with the restitution and friction of the pair.
  subroutine walls_of_two_materials()
    real(wp), parameter :: d = 1.0e-3_wp, down(3) = [0.0_wp, 0.0_wp, -1.0_wp], aside(3) = [0.0_wp, 1.0_wp, 0.0_wp]
    type(contact_settings_t) :: contact

    contact = three('linear')
    contact%wall_restitution = 0.8_wp
    contact%wall_friction = 0.15_wp
    call off_wall(contact, [5*d, 5*d, 0.501_wp*d], down, 2, 1, 'the floor')
    call off_wall(contact, [5*d, 5*d, 9.499_wp*d], -down, 2, 2, 'the roof')
    call off_wall(contact, [2*d, 3.501_wp*d, 5*d], -aside, 2, 3, 'a plane')
    call off_wall(contact, [2*d, 7.001_wp*d, 5*d], -aside, 2, 1, 'a pipe')
    call off_wall(contact, [5*d, 9.499_wp*d, 5*d], aside, 2, 0, 'a face of no material')
    call off_wall(contact, [5*d, 9.499_wp*d, 5*d], aside, 1, 0, 'a face of no material, another powder')
  end subroutine walls_of_two_materials

  !> Off the wall that lies in a direction, once straight and once, elastic, along it.
  subroutine off_wall(contact, place, direction, powder, wall, name)
    type(contact_settings_t), intent(in) :: contact
    real(wp), intent(in) :: place(3), direction(3)
    integer, intent(in) :: powder, wall  !< material of the latter
    character(len=*), intent(in) :: name

    real(wp), parameter :: d = 1.0e-3_wp, speed = 0.1_wp, along(3) = [1.0_wp, 0.0_wp, 0.0_wp]
    type(contact_settings_t) :: elastic
    type(solids_t) :: ball
    real(wp) :: k_ab, e_ab, mu_ab

    k_ab = k(powder)
    e_ab = 0.8_wp
    mu_ab = 0.15_wp
    if (wall > 0) call rule(powder, wall, k_ab, e_ab, mu_ab)
    ball = box(contact)
    call put(ball, column(place), column(speed*direction), [d], powder=[powder])
    call run(ball, 2500, pi*sqrt(mass_of(d)/k_ab)/1000)
    call expect_close(-dot_product(ball%parcels%state(5:7, 1), direction)/speed, e_ab, 1.0e-3_wp, 'bounce off '//name)
    elastic = contact
    elastic%materials%restitution = 1.0_wp
    elastic%pairs(1)%restitution = 1.0_wp
    elastic%wall_restitution = 1.0_wp
    ball = box(elastic)
    call put(ball, column(place), column(speed*direction + 20*speed*along), [d], powder=[powder])
    call run(ball, 2500, pi*sqrt(mass_of(d)/k_ab)/1000)
    call expect_close((20*speed - ball%parcels%state(5, 1))/(2*speed), mu_ab, 2.0e-3_wp, 'slide along '//name)
  end subroutine off_wall

  function box(contact) result(solids)
    type(contact_settings_t), intent(in) :: contact
    type(solids_t) :: solids

    real(wp), parameter :: d = 1.0e-3_wp
    type(wall_settings_t) :: walls(2)
    type(chamber_t) :: chamber

    chamber%lower = 0.0_wp
    chamber%upper = 10*d
    chamber%face_material = [0, 0, 0, 0, 1, 2]
    walls = [plane([0.0_wp, 3*d, 0.0_wp], [0.0_wp, 1.0_wp, 0.0_wp]), cylinder([0.0_wp, 6*d, 5*d], [1.0_wp, 0.0_wp, 0.0_wp], d/2)]
    walls%material = [3, 1]
    walls(2)%side = 'outside'
    call chamber%add_walls(walls)
    call solids%create(comm, chamber, contact, des_settings_t(), .false., 0.0_wp)
  end function box

  !> A ball in a corner touches two walls of different materials at a time, and bounces off each as off that alone.
  subroutine corner()
    real(wp), parameter :: d = 1.0e-3_wp, speed = 0.1_wp
    type(contact_settings_t) :: contact
    type(chamber_t) :: chamber
    type(solids_t) :: ball
    real(wp) :: e_1, e_2, x(3, 70), v(3, 70)
    integer :: i

    contact = three('linear')
    contact%materials%friction = 0.0_wp
    contact%pairs(1)%friction = 0.0_wp
    chamber%lower = 0.0_wp
    chamber%upper = [10*d, 100*d, 10*d]
    chamber%face_material = [1, 0, 0, 0, 2, 0]
    call ball%create(comm, chamber, contact, des_settings_t(), .false., 0.0_wp)
    ! So many that a block is full, of two powders in turn.
    do i = 1, 70
      x(:, i) = [0.501_wp, 1.2_wp*i, 0.501_wp]*d
      v(:, i) = [-speed, 0.0_wp, -speed]
    end do
    call put(ball, x, v, [(d, i=1, 70)], powder=[(merge(2, 3, modulo(i, 2) == 0), i=1, 70)])
    call run(ball, 2000, pi*sqrt(mass_of(d)/4000)/500)
    e_1 = 0.0_wp
    e_2 = 0.0_wp
    do i = 1, 70
      associate (s => ball%parcels%state(:, i))
        if (ball%parcels%powder(i) == 2) then
          e_1 = max(e_1, abs(s(5)/speed - sqrt(0.45_wp)), abs(s(7)/speed - 0.5_wp))
        else
          e_2 = max(e_2, abs(s(5)/speed - 0.6_wp), abs(s(7)/speed - sqrt(0.35_wp)))
        end if
      end associate
    end do
    call expect_close(e_1, 0.0_wp, 1.0e-3_wp, 'in a corner of two materials, a ball of one of them')
    call expect_close(e_2, 0.0_wp, 1.0e-3_wp, 'and one of a third')
  end subroutine corner

  !> The step is that of the shortest collision that may be: each pair's stiffness with its own lightest parcels.
  subroutine time_step()
    real(wp), parameter :: d(4) = [1.0e-3_wp, 2.0e-3_wp, 1.5e-3_wp, 3.0e-3_wp], density(3) = [8000.0_wp, 500.0_wp, 2500.0_wp]
    type(contact_settings_t) :: contact
    type(solids_t) :: solids
    real(wp) :: m(3), shortest, x(3, 4)
    real(wp) :: k_ab, e_ab, mu_ab
    integer :: a, b

    contact = three('linear')
    contact%materials%restitution = 1.0_wp
    contact%pairs(1)%restitution = 1.0_wp
    m = density*pi/6*d(:3)**3
    x = reshape([(0.004_wp*a, 0.004_wp, 0.004_wp, a=1, 4)], [3, 4])
    solids = scene(comm, [0.02_wp, 0.02_wp, 0.02_wp], 0.0_wp, contact)
    call put(solids, x, 0*x, d, density=[density, 2500.0_wp], powder=[1, 2, 3, 3])
    shortest = huge(shortest)
    do a = 1, n
      do b = a, n
        call rule(a, b, k_ab, e_ab, mu_ab)
        shortest = min(shortest, pi*sqrt(m(a)*m(b)/(m(a) + m(b))/k_ab))
      end do
      shortest = min(shortest, pi*sqrt(m(a)/k(a)))
    end do
    call expect_close(solids%time_step_limit(), shortest/20, 1.0e-12_wp, 'the step is that of the shortest collision of a pair')
    ! Without the second powder, light and stiff, it is longer; the others' lightest count although they came earlier or later.
    solids = scene(comm, [0.02_wp, 0.02_wp, 0.02_wp], 0.0_wp, contact)
    call put(solids, x(:, 4:4), 0*x(:, 4:4), d(4:4), powder=[3])
    call expect_close(solids%time_step_limit(), pi*sqrt(2500*pi/6*d(4)**3/2/k(3))/20, 1.0e-12_wp, 'of one powder, its own')
    call put(solids, x(:, 1:3:2), 0*x(:, 1:3:2), d(1:3:2), density=density(1:3:2), powder=[1, 3])
    shortest = min(pi*sqrt(m(1)/2/k(1)), pi*sqrt(m(3)/2/k(3)), pi*sqrt(m(1)*m(3)/(m(1) + m(3))/3000))
    call expect_close(solids%time_step_limit(), shortest/20, 1.0e-12_wp, 'of two, the shortest of theirs')
  end subroutine time_step

  !> The same of Hertz's law, with the radius of the pair; a wall of a hard material makes it shorter.
  subroutine time_step_of_hertz()
    real(wp), parameter :: d(2) = [1.0e-3_wp, 2.0e-3_wp]
    type(contact_settings_t) :: contact
    type(solids_t) :: solids
    real(wp) :: m(2), x(3, 2), time(4)

    contact = three('hertz')
    contact%wall_youngs_modulus = 1.0e9_wp
    m = [mass_of(d(1)), mass_of(d(2))]
    x = reshape([0.004_wp, 0.004_wp, 0.004_wp, 0.012_wp, 0.012_wp, 0.012_wp], [3, 2])
    solids = scene(comm, [0.02_wp, 0.02_wp, 0.02_wp], 0.0_wp, contact)
    call put(solids, x, 0*x, d, powder=[1, 2])
    time = [lasts(m(1)/2, d(1)/4, soft(1) + soft(1)), lasts(m(2)/2, d(2)/4, soft(2) + soft(2)), &
            lasts(product(m)/sum(m), product(d)/sum(d)/2, soft(1) + soft(2)), &
            min(lasts(m(1), d(1)/2, soft(1) + (1 - poisson(1)**2)/1.0e9_wp), &
                lasts(m(2), d(2)/2, soft(2) + (1 - poisson(2)**2)/1.0e9_wp))]
    call expect_close(solids%time_step_limit(), minval(time)/20, 1.0e-6_wp, 'the step of Hertz''s contacts of two materials')
  end subroutine time_step_of_hertz

  !> (1 - nu^2)/E [1/Pa]
  pure function soft(material)
    integer, intent(in) :: material
    real(wp) :: soft

    soft = (1 - poisson(material)**2)/modulus(material)
  end function soft

  !> Of an elastic collision at 1 m/s [s].
  pure function lasts(mass, radius, compliance)
    real(wp), intent(in) :: mass, radius, compliance  !< effective ones [kg], [m]; 1/modulus [1/Pa]
    real(wp) :: lasts

    lasts = 2.943275_wp*(15*mass*compliance/(16*sqrt(radius)))**0.4_wp
  end function lasts

  !> Materials that do not differ are one: one law, no dealt lists, and the same run bit for bit.
  subroutine equal_materials()
    type(contact_settings_t) :: one, several
    type(solids_t) :: alone, together

    one%stiffness = 1000.0_wp
    one%restitution = 0.8_wp
    one%friction = 0.3_wp
    several = one
    several%materials = [material_settings_t(restitution=0.8_wp), material_settings_t(), material_settings_t(friction=0.3_wp)]
    allocate (several%pairs(0))
    several%powder_material = [1, 2, 3]
    alone = shaken(one)
    together = shaken(several)
    call expect(size(together%laws%pair) == 1 .and. size(together%laws%wall) == 1 .and. .not. allocated(together%parts), &
                'equal materials have one law')
    call expect(.not. any(abs(alone%parcels%state(:, :60) - together%parcels%state(:, :60)) > 0), &
                'and move as one, bit for bit')
  end subroutine equal_materials

  !> Dealing a list makes no difference but rounding: materials that differ in the last digits move as one, sticky as they are.
  subroutine dealt_or_not()
    type(contact_settings_t) :: one, several
    type(solids_t) :: alone, together
    real(wp) :: way
    integer :: i, j

    one%stiffness = 1000.0_wp
    one%restitution = 0.8_wp
    one%friction = 0.3_wp
    one%rolling = 'spring'
    one%rolling_friction = 0.2_wp
    one%cohesion = 'van_der_waals'
    one%hamaker_constant = 1.0e-14_wp
    one%minimum_separation = 1.0e-7_wp
    one%maximum_separation = 1.0e-5_wp
    several = one
    several%materials = [material_settings_t(), material_settings_t(stiffness=1000.0_wp*(1 + 2.0e-14_wp)), &
                         material_settings_t(stiffness=1000.0_wp*(1 - 1.0e-14_wp))]
    allocate (several%pairs(0))
    several%powder_material = [1, 2, 3]
    alone = shaken(one)
    together = shaken(several)
    call expect(size(together%laws%pair) == 6 .and. size(together%laws%wall) == 3, 'materials that differ have a law each')
    way = 0.0_wp
    do i = 1, 60
      j = findloc(together%parcels%id(1:60), alone%parcels%id(i), 1)
      way = max(way, norm2(alone%parcels%state(1:3, i) - together%parcels%state(1:3, j)))
    end do
    call expect(way < 1.0e-12_wp .and. alone%rebuilds > 1, 'dealt or not, parcels move the same but for rounding')
  end subroutine dealt_or_not

  !> Sixty balls of three powders fall on a heap.
  function shaken(contact) result(solids)
    type(contact_settings_t), intent(in) :: contact
    type(solids_t) :: solids

    real(wp) :: x(3, 60), v(3, 60)
    integer :: i

    do i = 1, 60
      x(:, i) = ([modulo(i - 1, 4), modulo((i - 1)/4, 4), (i - 1)/16] + 0.6_wp + 0.05_wp*sin(i*[1.0_wp, 2.0_wp, 3.0_wp]))*1.1e-3_wp
      v(:, i) = 0.3_wp*sin(i*[3.0_wp, 5.0_wp, 7.0_wp])
    end do
    solids = scene(comm, [0.005_wp, 0.005_wp, 0.02_wp], -9.81_wp, contact)
    call put(solids, x, v, [(1.0e-3_wp, i=1, 60)], powder=[(1 + modulo(i, 3), i=1, 60)])
    call run(solids, 400, 0.5_wp*solids%time_step_limit())
  end function shaken

end program test_materials
