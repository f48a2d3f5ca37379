!> Contacts of parcels scaled from those of particles: what the case makes of it, and what the collisions are like.
! ranks: 1
program test_coarse_graining
  use case, only: case_t
  use case_reading, only: read_case_text
  use check, only: expect, expect_close, finish
  use communicator, only: communicator_t, start_ranks, stop_ranks
  use contact_pairs, only: pair_t, pair_of, wall_pair_of, scaled_restitution
  use contact_settings, only: contact_settings_t
  use des_scenes, only: scene, put, run
  use kinds, only: wp
  use problems, only: problems_t
  use solids, only: solids_t
  use solids_statistics, only: statistics_t, find_statistics
  implicit none

  !> What a head-on collision of two equal parcels was like.
  type :: collision_t
    real(wp) :: overlap      !< largest, over the radius [-]
    real(wp) :: duration     !< [s]
    real(wp) :: restitution  !< [-]
  end type collision_t

  character(len=1), parameter :: nl = achar(10)
  character(len=256), parameter :: none(0) = ' '
  character(len=*), parameter :: bed = '&run end_time = 1 /'//nl// &
    '&domain lower = 3*0, upper = 0.1, 0.4, 0.1 /'//nl// &
    '&powder id = ''glass'', density = 2500, distribution = ''normal'', mean_diameter = 1e-3, standard_deviation = 2e-4, ' &
    //'minimum_diameter = 5e-4, maximum_diameter = 1.5e-3 /'//nl// &
    '&fill id = ''bed'', powder = ''glass'', mass = 0.2, lower = 3*0, upper = 0.1, 0.1, 0.1 /'//nl
  type(communicator_t) :: comm

  call start_ranks(comm)
  call ssw_and_ssp()
  call attraction()
  call limits()
  call collide_parcels()
  call finish()
  call stop_ranks()

contains

  !> Settings of the parcels, from settings of the particles.
  function contact_of(groups) result(contact)
    character(len=*), intent(in) :: groups
    type(contact_settings_t) :: contact

    type(case_t) :: made
    type(problems_t) :: problems

    call read_case_text(bed//groups, none, made, problems)
    if (problems%count() > 0) print '(2a)', 'FAIL ', problems%message(1)
    contact = made%contact
  end function contact_of

  !> Of two parcels [N/m].
  pure function stiffness(contact)
    type(contact_settings_t), intent(in) :: contact
    real(wp) :: stiffness

    type(pair_t) :: pair

    pair = pair_of(contact, 0, 0)
    stiffness = pair%stiffness
  end function stiffness

  !> Of a parcel and a wall [N/m].
  pure function wall_stiffness(contact)
    type(contact_settings_t), intent(in) :: contact
    real(wp) :: wall_stiffness

    type(pair_t) :: pair

    pair = wall_pair_of(contact, 0, 0)
    wall_stiffness = pair%stiffness
  end function wall_stiffness

  !> Of two parcels.
  pure function restitution(contact)
    type(contact_settings_t), intent(in) :: contact
    real(wp) :: restitution

    type(pair_t) :: pair

    pair = pair_of(contact, 0, 0)
    restitution = pair%restitution
  end function restitution

  !> An attraction that is the same part of the weight: Hamaker's constant l^2, the energy of an area l^(1/3) times as large.
  subroutine attraction()
    character(len=*), parameter :: law = '&contact law = ''hertz'', youngs_modulus = 1e7, poisson_ratio = 0.25, '
    character(len=*), parameter :: area = 'cohesion = ''linear'', cohesion_energy = 1e4, wall_cohesion_energy = 2e4'
    character(len=*), parameter :: van_der_waals = 'cohesion = ''van_der_waals'', hamaker_constant = 1e-19, ' &
      //'wall_hamaker_constant = 2e-19, minimum_separation = 1e-9, maximum_separation = 1e-7'
    character(len=*), parameter :: bond = ', cohesion_scaling = ''bond_number'' /'
    character(len=*), parameter :: ssw = '&parcels weighting = ''ssw'', weight = 27 /'//nl
    type(contact_settings_t) :: contact
    type(pair_t) :: pair, wall

    contact = contact_of(ssw//law//van_der_waals//bond)
    pair = pair_of(contact, 0, 0)
    wall = wall_pair_of(contact, 0, 0)
    call expect_close(pair%hamaker_constant, 9.0e-19_wp, 1.0e-12_wp, 'Hamaker''s constant is l^2 times as large')
    call expect_close(wall%hamaker_constant, 18.0e-19_wp, 1.0e-12_wp, 'and that of walls')
    call expect_close(contact%minimum_separation, 1.0e-9_wp, 1.0e-12_wp, 'at equal gaps')
    contact = contact_of(ssw//law//area//bond)
    pair = pair_of(contact, 0, 0)
    wall = wall_pair_of(contact, 0, 0)
    call expect_close(pair%cohesion_energy, 3.0_wp**(1.0_wp/3.0_wp)*1.0e4_wp, 1.0e-12_wp, 'an energy l^(1/3) times')
    call expect_close(wall%cohesion_energy, 3.0_wp**(1.0_wp/3.0_wp)*2.0e4_wp, 1.0e-12_wp, 'and that of walls')
    pair = pair_of(contact_of(ssw//law//van_der_waals//' /'), 0, 0)
    call expect_close(pair%hamaker_constant, 1.0e-19_wp, 1.0e-12_wp, 'unless asked for, nothing is scaled')
  end subroutine attraction

  !> SSW of weight 27 is 3 times as wide; SSP as wide as the cube root of the mean volume makes it.
  subroutine ssw_and_ssp()
    character(len=*), parameter :: scaled = '&contact stiffness = 50, wall_stiffness = 80, restitution = 0.95, ' &
      //'stiffness_scaling = ''constant_modulus'', restitution_scaling = ''dissipation'' /'
    real(wp), parameter :: e = sqrt(1 - 3*(1 - 0.95_wp**2))
    type(contact_settings_t) :: contact
    real(wp) :: l

    contact = contact_of('&parcels weighting = ''ssw'', weight = 27 /'//nl//scaled)
    call expect_close(stiffness(contact), 150.0_wp, 1.0e-12_wp, 'ssw: the spring is l times as stiff')
    call expect_close(wall_stiffness(contact), 240.0_wp, 1.0e-12_wp, 'and so is that of walls')
    call expect_close(restitution(contact), e, 1.0e-12_wp, 'e_cg^2 = 1 - l (1 - e^2)')
    contact = contact_of('&parcels weighting = ''dem'' /'//nl//scaled)
    call expect_close(stiffness(contact), 50.0_wp, 1.0e-12_wp, 'dem: nothing is scaled')
    call expect_close(restitution(contact), 0.95_wp, 1.0e-12_wp, 'dem: nor here')
    contact = contact_of('&parcels weighting = ''ssp'', diameter = 3e-3 /'//nl//scaled)
    ! <d^3> = mean^3 + 3 mean deviation^2 of the symmetric, almost unclipped distribution: 1.1 mm^3 by its limits
    l = stiffness(contact)/50
    call expect(abs(l*(1.12_wp)**(1.0_wp/3.0_wp)/3 - 1) < 5.0e-3_wp, 'ssp: l is D over the width of the mean volume')
    call expect_close(restitution(contact), sqrt(1 - l*(1 - 0.95_wp**2)), 1.0e-12_wp, 'ssp: the same l')
    contact = contact_of('&parcels weighting = ''ssw'', weight = 27 /'//nl//'&contact stiffness = 50, restitution = 0.95 /')
    call expect_close(stiffness(contact), 50.0_wp, 1.0e-12_wp, 'without being asked nothing is scaled')
  end subroutine ssw_and_ssp

  !> The widest parcels that can dissipate enough: l = 1/(1 - e^2).
  subroutine limits()
    call expect_close(scaled_restitution(1/(1 - 0.9_wp**2)*(1 - 1.0e-12_wp), 0.9_wp), 0.0_wp, 2.0e-6_wp, &
                      'nothing is left at l = 1/(1 - e^2)')
    call expect_close(scaled_restitution(2.0_wp, 0.9_wp), 0.787401_wp, 1.0e-6_wp, 'e 0.9 at l = 2')
    call expect_close(scaled_restitution(3.0_wp, 0.9_wp), 0.655744_wp, 1.0e-6_wp, 'e 0.9 at l = 3')
  end subroutine limits

  !> Same modulus: the same overlap over radius, and a collision that takes l times as long.
  subroutine collide_parcels()
    type(collision_t) :: particle, parcel
    real(wp), parameter :: l = 3.0_wp, e = 0.95_wp

    particle = collided(1.0_wp, 500.0_wp, e)
    parcel = collided(l**3, l*500.0_wp, e)
    call expect_close(parcel%overlap, particle%overlap, 1.0e-6_wp, 'constant modulus: overlaps over radius stay')
    call expect_close(parcel%duration, l*particle%duration, 1.0e-6_wp, 'constant modulus: a collision takes l times as long')
    parcel = collided(l**3, 500.0_wp, e)
    ! The deepest of about 400 steps is off by up to (pi/400)^2/8.
    call expect_close(parcel%overlap, sqrt(l)*particle%overlap, 1.0e-5_wp, 'constant stiffness: overlaps grow as sqrt(l)')
    parcel = collided(l**3, l*500.0_wp, scaled_restitution(l, e))
    call expect_close(1 - parcel%restitution**2, l*(1 - e**2), 3.0e-3_wp, 'a collision of parcels dissipates l times as much')
  end subroutine collide_parcels

  !> Two parcels of 1 mm particles meet at 1 m/s.
  function collided(weight, stiffness, restitution) result(collision)
    real(wp), intent(in) :: weight, stiffness, restitution  !< [-], [N/m], [-]
    type(collision_t) :: collision

    type(contact_settings_t) :: contact
    type(solids_t) :: solids
    type(statistics_t) :: s
    real(wp) :: dt, d
    integer :: step

    contact%stiffness = stiffness
    contact%restitution = restitution
    d = 1.0e-3_wp*weight**(1.0_wp/3.0_wp)
    solids = scene(comm, [10*d, 10*d, 10*d], 0.0_wp, contact)
    call put(solids, reshape([4.499_wp, 5.0_wp, 5.0_wp, 5.501_wp, 5.0_wp, 5.0_wp]*d, [3, 2]), &
             reshape([0.5_wp, 0.0_wp, 0.0_wp, -0.5_wp, 0.0_wp, 0.0_wp], [3, 2]), spread(1.0e-3_wp, 1, 2), spread(weight, 1, 2))
    dt = solids%time_step_limit()/20
    collision%overlap = 0.0_wp
    collision%duration = solids%time_step_limit()*solids%numerics%steps_per_collision
    do step = 1, 500
      call run(solids, 1, dt)
      s = find_statistics(solids)
      collision%overlap = max(collision%overlap, s%max_overlap)
    end do
    call expect(s%contacts == 0, 'the collision is over')
    collision%restitution = abs(solids%parcels%state(5, 2) - solids%parcels%state(5, 1))
  end function collided

end program test_coarse_graining
