!> From powders to parcels: sizes, weights and places, the same whatever the number of ranks.
!>
!> Fills that share space are placed together, so powders can be mixed in one box. Parcels of a file stay where the
!> file says, and the others keep clear of them.
module generator
  use cloud, only: cloud_t, new_cloud
  use constants, only: is_set
  use kinds, only: wp
  use outcome, only: outcome_t, exit_input
  use packing, only: box_t, pack_spheres, has_overlap
  use parcel_file, only: read_parcel_file
  use parcels_settings, only: parcels_settings_t, fill_settings_t
  use powder_settings, only: powder_settings_t
  use random_numbers, only: random_t, new_random
  use sampling, only: draw_number, draw_mass, mean_parcel_mass
  use size_audit, only: size_audit_t, summary_asked, summary_made
  use size_distribution, only: size_distribution_t, new_size_distribution
  use sphere_pairs, only: spheres_t, pairs_t, find_pairs
  use text, only: brief, shown
  use vessel, only: vessel_t
  use weighting, only: weighting_t, new_weighting, sphere_volume
  implicit none
  private
  public :: generate

  real(wp), parameter :: tolerance = 1.0e-9_wp  !< relative, of weights and lengths
  real(wp), parameter :: deepest = 0.5_wp       !< distance over the sum of radii below which spheres are one in the other

contains

  !> All parcels of a case and, of each powder, what they carry beside what was asked. For one rank to call.
  subroutine generate(powders, settings, fills, vessel, cloud, audits, outcome)
    type(powder_settings_t), intent(in) :: powders(:)
    type(parcels_settings_t), intent(in) :: settings
    type(fill_settings_t), intent(in) :: fills(:)
    type(vessel_t), intent(in) :: vessel
    type(cloud_t), intent(out) :: cloud
    type(size_audit_t), allocatable, intent(out) :: audits(:)  !< by powder
    type(outcome_t), intent(inout) :: outcome

    type(weighting_t) :: weighting
    type(cloud_t) :: parcels
    integer :: i

    allocate (audits(size(powders)))
    audits%powder = powders%id
    cloud = new_cloud(0)
    call new_weighting(settings, weighting, outcome)
    do i = 1, size(fills)
      if (outcome%failed()) return
      if (len_trim(fills(i)%file) > 0) then
        call read_parcel_file(fills(i), weighting, vessel, parcels, outcome)
      else
        call draw(powders(fills(i)%powder), weighting, fills(i), new_random(settings%seed, i), parcels, outcome)
      end if
      if (outcome%failed()) return
      parcels%powder(:) = fills(i)%powder
      parcels%density(:) = powders(fills(i)%powder)%density
      parcels%fill(:) = i
      call cloud%append(parcels)
    end do
    call place(fills, settings%seed, vessel, cloud, outcome)
    if (.not. outcome%failed()) call audit_all(powders, weighting, fills, cloud, audits, outcome)
  end subroutine generate

  !> The parcels of a fill: sizes that carry the powder, in random order, without places.
  subroutine draw(powder, weighting, fill, stream, parcels, outcome)
    type(powder_settings_t), intent(in) :: powder
    type(weighting_t), intent(in) :: weighting
    type(fill_settings_t), intent(in) :: fill
    type(random_t), intent(in) :: stream
    type(cloud_t), intent(out) :: parcels
    type(outcome_t), intent(inout) :: outcome

    type(size_distribution_t) :: distribution
    type(random_t) :: random
    real(wp), allocatable :: diameter(:)
    integer, allocatable :: order(:)
    real(wp) :: number

    call new_size_distribution(powder, distribution, outcome)
    if (outcome%failed()) return
    number = fill%number
    if (is_set(fill%mass)) number = fill%mass/mean_parcel_mass(distribution, weighting, powder%density)
    call check_number(fill, number, outcome)
    if (outcome%failed()) return
    if (is_set(fill%mass)) then
      call draw_mass(distribution, weighting, powder%density, fill%mass, diameter)
    else
      call draw_number(distribution, weighting, fill%number, diameter)
    end if
    allocate (order(size(diameter)))
    random = stream
    call random%shuffle(order)
    parcels = new_cloud(size(diameter))
    parcels%diameter(:) = diameter(order)
    parcels%weight(:) = weighting%weight(parcels%diameter)
    parcels%contact_diameter(:) = weighting%collision_diameter(parcels%diameter)
    parcels%velocity(:, :) = spread(fill%velocity, 2, parcels%n)
    if (minval(parcels%weight) < 1.0_wp - tolerance) call outcome%fail(exit_input, '&parcels: '// &
      "a parcel of powder '"//trim(powder%id)//"' would hold less than one particle, "//brief(minval(parcels%weight))// &
      '; make weight or diameter larger')
  end subroutine draw

  !> A fill holds at least a parcel and no more than can be counted.
  pure subroutine check_number(fill, number, outcome)
    type(fill_settings_t), intent(in) :: fill
    real(wp), intent(in) :: number  !< of parcels
    type(outcome_t), intent(inout) :: outcome

    if (number < 0.5_wp) call outcome%fail(exit_input, label(fill)//': its mass is less than half a parcel, '// &
                                           brief(number)//'; a mean parcel weighs '//brief(fill%mass/number)//' kg')
    if (number > 0.1_wp*huge(1)) call outcome%fail(exit_input, label(fill)//': would be '//brief(number)// &
                                                  ' parcels; give them a larger weight or diameter')
  end subroutine check_number

  !> Place the parcels in the boxes of their fills, clear of each other.
  subroutine place(fills, seed, vessel, cloud, outcome)
    type(fill_settings_t), intent(in) :: fills(:)
    integer, intent(in) :: seed
    type(vessel_t), intent(in) :: vessel
    type(cloud_t), intent(inout) :: cloud
    type(outcome_t), intent(inout) :: outcome

    type(spheres_t) :: spheres
    type(box_t) :: boxes(size(fills))
    type(random_t) :: random
    logical, allocatable :: placed(:)
    integer :: i

    spheres%vessel = vessel
    allocate (spheres%position, source=cloud%position)
    allocate (spheres%radius, source=0.5_wp*cloud%contact_diameter)
    allocate (spheres%box, source=cloud%fill)
    do i = 1, size(fills)
      if (len_trim(fills(i)%file) > 0) then
        where (cloud%fill == i) spheres%box = 0
        boxes(i) = box_t(vessel%lower, vessel%upper, vessel%periodic)
      else
        boxes(i) = box_of(fills(i), vessel)
        call check_room(fills(i), boxes(i), maxval(cloud%contact_diameter, cloud%fill == i), vessel, outcome)
      end if
    end do
    call check_held(spheres, outcome)
    if (outcome%failed()) return
    random = new_random(seed, 0)
    call pack_spheres(boxes, random, spheres, placed)
    do i = 1, size(fills)
      if (.not. all(placed .or. cloud%fill /= i)) call report_left_out(fills(i), cloud, cloud%fill == i, placed, outcome)
    end do
    if (outcome%failed()) return
    if (has_overlap(spheres)) error stop 'packing: placed spheres overlap'
    cloud%position(:, :) = spheres%position
  end subroutine place

  !> The box of a fill, joined to itself in periodic directions that it fills.
  pure function box_of(fill, vessel) result(box)
    type(fill_settings_t), intent(in) :: fill
    type(vessel_t), intent(in) :: vessel
    type(box_t) :: box

    real(wp) :: slack(3)

    slack = tolerance*(vessel%upper - vessel%lower)
    box%lower = merge(fill%lower, vessel%lower, abs(fill%lower - vessel%lower) > slack)
    box%upper = merge(fill%upper, vessel%upper, abs(fill%upper - vessel%upper) > slack)
    box%spans = vessel%periodic .and. fill%lower <= vessel%lower + slack .and. fill%upper >= vessel%upper - slack
  end function box_of

  !> A box lies in the vessel and is as wide as its widest parcel.
  pure subroutine check_room(fill, box, widest, vessel, outcome)
    type(fill_settings_t), intent(in) :: fill
    type(box_t), intent(in) :: box
    real(wp), intent(in) :: widest  !< diameter [m]
    type(vessel_t), intent(in) :: vessel
    type(outcome_t), intent(inout) :: outcome

    real(wp) :: slack(3)

    slack = tolerance*(vessel%upper - vessel%lower)
    if (any(box%lower < vessel%lower - slack) .or. any(box%upper > vessel%upper + slack)) then
      call outcome%fail(exit_input, label(fill)//': its box reaches out of the domain')
    end if
    if (any(box%upper - box%lower < widest*(1.0_wp - tolerance))) then
      call outcome%fail(exit_input, label(fill)//': its widest parcel, '//brief(widest)//' m, is wider than its box, '// &
                        brief(minval(box%upper - box%lower))//' m')
    end if
  end subroutine check_room

  !> Parcels of a file may touch, as in a bed at rest, but not sit inside each other.
  subroutine check_held(spheres, outcome)
    type(spheres_t), intent(in) :: spheres
    type(outcome_t), intent(inout) :: outcome

    type(pairs_t) :: pairs
    integer :: i, j, pair

    if (all(spheres%box > 0)) return
    call find_pairs(spheres, 0.0_wp, pairs)
    do i = 1, size(spheres%radius)
      do pair = pairs%first(i), pairs%first(i + 1) - 1
        j = pairs%with(pair)
        if (spheres%box(i) > 0 .or. spheres%box(j) > 0) cycle
        associate (way => spheres%vessel%shortest(spheres%position(:, j) - spheres%position(:, i)))
          if (norm2(way) < deepest*(spheres%radius(i) + spheres%radius(j))) call outcome%fail(exit_input, &
            '&fill: parcels '//shown(min(i, j))//' and '//shown(max(i, j))// &
            ', which come from a file, are one inside the other')
        end associate
      end do
    end do
  end subroutine check_held

  !> Say how much of a fill its box holds.
  subroutine report_left_out(fill, cloud, mine, placed, outcome)
    type(fill_settings_t), intent(in) :: fill
    type(cloud_t), intent(in) :: cloud
    logical, intent(in) :: mine(:)    !< whether each parcel is of this fill
    logical, intent(in) :: placed(:)  !< whether each parcel found a place
    type(outcome_t), intent(inout) :: outcome

    real(wp) :: mass(cloud%n), fraction(2)

    mass = cloud%density*sphere_volume(cloud%diameter)*cloud%weight
    fraction = [sum(sphere_volume(cloud%contact_diameter), mine), &
                sum(sphere_volume(cloud%contact_diameter), mine .and. placed)]/product(fill%upper - fill%lower)
    call outcome%fail(exit_input, label(fill)//': '//shown(count(mine))//' parcels, '//brief(sum(mass, mine))// &
      ' kg, do not fit into its box without overlap (solids fraction '//brief(fraction(1))//'); '// &
      shown(count(mine .and. placed))//' parcels, '//brief(sum(mass, mine .and. placed))//' kg, do (solids fraction '// &
      brief(fraction(2))//'). Give a larger box or less mass')
  end subroutine report_left_out

  !> Compare what was asked of each powder with what the parcels carry.
  subroutine audit_all(powders, weighting, fills, cloud, audits, outcome)
    type(powder_settings_t), intent(in) :: powders(:)
    type(weighting_t), intent(in) :: weighting
    type(fill_settings_t), intent(in) :: fills(:)
    type(cloud_t), intent(in) :: cloud
    type(size_audit_t), intent(inout) :: audits(:)
    type(outcome_t), intent(inout) :: outcome

    type(size_distribution_t) :: distribution
    real(wp) :: mass
    integer :: i, j

    do i = 1, size(powders)
      associate (mine => cloud%powder == i)
        audits(i)%parcels = count(mine)
        audits(i)%made = summary_made(pack(cloud%diameter, mine), pack(cloud%weight, mine), powders(i)%density)
      end associate
      ! What a file holds was not drawn from the powder's distribution.
      if (any(len_trim(fills%file) > 0 .and. fills%powder == i) .or. all(fills%powder /= i)) cycle
      call new_size_distribution(powders(i), distribution, outcome)
      mass = 0.0_wp
      do j = 1, size(fills)
        if (fills(j)%powder /= i) cycle
        if (is_set(fills(j)%mass)) mass = mass + fills(j)%mass
        if (.not. is_set(fills(j)%mass)) then
          mass = mass + fills(j)%number*mean_parcel_mass(distribution, weighting, powders(i)%density)
        end if
      end do
      audits(i)%asked = summary_asked(distribution, powders(i)%density, mass)
    end do
  end subroutine audit_all

  pure function label(fill) result(name)
    type(fill_settings_t), intent(in) :: fill
    character(len=:), allocatable :: name

    name = '&fill('//trim(fill%id)//')'
  end function label

end module generator
